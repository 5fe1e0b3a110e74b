// One scene as the comparison moves it: two different frames, and the rays of each.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lab/commands/compare/peer.h"
#include "lab/commands/compare/words.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/types.h"

namespace raysheaf::app {

/// The first frame is the scene. In the second one every vertex is displaced along a smooth field,
/// by at most a hundredth of the scene's diagonal, and the triangles of each mesh are in reverse
/// order. Frames alternate, so neither side sees the same data twice in a row.
class CompareFrames {
 public:
  static constexpr std::size_t kFrames = 2;

  /// Without `moving` there is no second frame. Instances become meshes in world space, except
  /// those without triangles. Throws `Error` as `Laboratory` does.
  CompareFrames(const SceneDescription& scene, bool moving);

  [[nodiscard]] std::uint64_t triangle_count() const;
  [[nodiscard]] std::size_t frame_count() const { return frames_.size(); }
  /// With `same_indices` the triangles of the second frame keep the order of the first.
  [[nodiscard]] std::vector<MeshView> meshes(std::size_t frame, bool same_indices) const;
  [[nodiscard]] const std::vector<Ray>& rays(std::size_t frame, CompareKind kind) const;
  /// The length that distances are compared with.
  [[nodiscard]] float diagonal() const;

  /// Makes the rays of some kinds; no other kinds may be requested later. Images are `width` by
  /// `height`; ambient occlusion halves each side, so that its four rays per point give the same
  /// number of rays.
  void make_rays(const std::vector<CompareKind>& kinds, std::uint32_t width, std::uint32_t height,
                 std::uint32_t threads);
  /// Puts a square below the scene, of which the rays and the diagonal know nothing; it does not
  /// move.
  void set_ground(float half);

 private:
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  struct Frame {
    SceneDescription scene;
    std::vector<Triangles> reversed;  ///< of the second frame, by mesh
    std::array<std::vector<Ray>, 5> rays;
  };
  std::vector<Frame> frames_;
  Mesh ground_;
};

/// Numbers from 0 on, below 1, each from its place in a fixed sequence.
[[nodiscard]] float fraction_at(std::uint64_t place);
/// Rays from points all over the box, in uniform directions.
[[nodiscard]] std::vector<Ray> random_rays(const Box& box, std::uint64_t count);

}  // namespace raysheaf::app
