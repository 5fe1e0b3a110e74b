// One scene as the comparison moves it: two frames that differ, and the rays of each.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compare/peer.h"
#include "compare/words.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/types.h"

namespace raysheaf::app {

/// The first frame is the scene; in the second every vertex has moved along a smooth field, by a
/// hundredth of the scene's diagonal at most, and the triangles of each mesh stand in reverse
/// order. Frames alternate: neither side ever sees the same data twice in a row.
class CompareFrames {
 public:
  static constexpr std::size_t kFrames = 2;

  /// `moving` = false leaves the second frame out. Instances become meshes in world space; those
  /// without triangles are left out. Throws `Error` as `Laboratory` does.
  CompareFrames(const SceneDescription& scene, bool moving);

  [[nodiscard]] std::uint64_t triangle_count() const;
  [[nodiscard]] std::size_t frame_count() const { return frames_.size(); }
  /// The second frame's triangles stand in the first one's order where `same_indices`.
  [[nodiscard]] std::vector<MeshView> meshes(std::size_t frame, bool same_indices) const;
  [[nodiscard]] const std::vector<Ray>& rays(std::size_t frame, CompareKind kind) const;
  /// Lengths are judged against it.
  [[nodiscard]] float diagonal() const;

  /// Makes the rays of some kinds; others cannot be asked for. Pictures of `width` by `height`;
  /// ambient occlusion takes half of each, so that its four rays a point are as many.
  void make_rays(const std::vector<CompareKind>& kinds, std::uint32_t width, std::uint32_t height,
                 std::uint32_t threads);

 private:
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  struct Frame {
    SceneDescription scene;
    std::vector<Triangles> reversed;  ///< the second frame's, a mesh each
    std::array<std::vector<Ray>, 5> rays;
  };
  std::vector<Frame> frames_;
};

}  // namespace raysheaf::app
