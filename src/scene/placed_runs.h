// Instances of meshes in world space, as runs of numbered triangles: what the scene of ray queries
// and that of the renderer have in common.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/buffer.h"
#include "base/mirrors_body.h"
#include "base/vec.h"
#include "raysheaf/types.h"
#include "scene/motion.h"
#include "scene/triangle_source.h"

namespace raysheaf {

class Executor;

/// The most that are placed: a number and a bit.
inline constexpr std::uint64_t kMostPlacedTriangles = 0x7fffffff;

/// One instance of a mesh that has triangles. The arrays belong to someone else.
struct PlacedInstance {
  /// The vertices of the mesh, in its own space; those of corners are within `kLargestCoordinate`.
  View<const Vec3> positions;
  /// As `TriangleRun` has them.
  const std::array<std::uint32_t, 3>* triangles = nullptr;
  std::uint32_t triangle_count = 0;
  std::uint32_t geom_id = 0, inst_id = 0;
  Affine to_world;
  /// Differs from that of other arrays of the same mesh, and from that of former vertices in them.
  std::uint64_t shape = 0;
  /// `TriangleFlag` of each triangle, except `kMirrored`; null: none is set.
  const std::uint8_t* flags = nullptr;
  bool mirrored = false;  ///< the transform turns the winding; found by `PlacedRuns`
  /// Empty, or where the instance moves (scene/motion.h), from `to_world` on.
  View<const Affine> motion = {};
  /// Empty, or where its vertices move, from `positions` on.
  View<const View<const Vec3>> times = {};

  [[nodiscard]] bool is_identity() const { return to_world.m == Affine().m; }
  [[nodiscard]] bool moves() const { return !motion.empty() || !times.empty(); }
  /// The triangles in the space of the mesh, by one of the times.
  [[nodiscard]] TriangleRun mesh(std::size_t time = 0) const {
    const View<const Vec3> vertices = times.empty() ? positions : times[time];
    return {vertices.data, triangles, 0, triangle_count};
  }
};

/// The triangles of an instance in the world, each placed where it is asked for, so that it does
/// not matter whether the instance waits (`PlacedRuns`).
class InstanceCorners {
 public:
  InstanceCorners() = default;
  explicit InstanceCorners(const PlacedInstance& instance)
      : mesh_(instance.mesh()),
        to_world_(instance.to_world),
        is_identity_(instance.is_identity()),
        mirrored_(instance.mirrored) {}
  /// At a time.
  InstanceCorners(const PlacedInstance& instance, float time) : InstanceCorners(instance) {
    if (!instance.motion.empty()) {
      to_world_ = affine_at(instance.motion, time);
      is_identity_ = to_world_.m == Affine().m;
      mirrored_ = mirrors(to_world_);
    }
    if (instance.times.empty()) return;
    instant_ = Instant(time, instance.times.size);
    mesh_ = instance.mesh(instant_.before);
    after_ = instance.mesh(instant_.after);
  }

  [[nodiscard]] std::uint32_t count() const { return mesh_.count; }
  [[nodiscard]] bool mirrored() const { return mirrored_; }
  [[nodiscard]] std::array<Vec3, 3> operator()(std::uint32_t triangle) const {
    std::array<Vec3, 3> corners = mesh_.corners(triangle);
    if (instant_.before != instant_.after) {
      const std::array<Vec3, 3> after = after_.corners(triangle);
      for (std::size_t k = 0; k < 3; ++k) corners[k] = instant_.mixed(corners[k], after[k]);
    }
    if (!is_identity_)
      for (Vec3& corner : corners) corner = transform_point(to_world_, corner);
    return corners;
  }

 private:
  TriangleRun mesh_, after_;  ///< in its own space, at the two times of `instant_`
  Instant instant_{0, 1};
  Affine to_world_;
  bool is_identity_ = true, mirrored_ = false;
};

/// The runs of a list of instances. Instances with the identity transform share the vertices of
/// their mesh; every other instance has its vertices here, in world space.
class PlacedRuns {
 public:
  /// Sets the list, ascending by (geom_id, inst_id), of fewer than 2^32 instances. Those that were
  /// in the former list keep their vertices; `place` those that are new or have changed.
  /// O(instances).
  void list(std::vector<PlacedInstance> instances);
  /// Sets the instance of this number again: other arrays of the same sizes, or another transform.
  void set(std::uint32_t number, const PlacedInstance& instance) {
    instances_[number] = instance;
    settle(number);
  }
  /// Leaves the vertices of an instance, if it has any of its own, none of whose triangles'
  /// vertices may be farther out than `kLargestCoordinate`, to `place_waiting`. Until then its
  /// run's positions must not be read.
  void let_wait(std::uint32_t number);
  [[nodiscard]] bool waits(std::size_t number) const { return waits_[number] != 0; }
  /// Places the instances that wait. O(their vertices). `entered`: empty, or not zero for those
  /// that go on waiting. The triangles of the others must be few enough (`kMostPlacedTriangles`).
  void place_waiting(const Executor& executor, View<const std::uint8_t> entered = {});
  [[nodiscard]] bool is_waiting() const { return waiting_ != 0; }
  [[nodiscard]] std::uint64_t waiting_triangles() const { return waiting_; }
  /// Transforms the vertices of the instances of these numbers (no number twice). Returns the least
  /// `inst_id` of an instance that puts a vertex of a triangle farther out than
  /// `kLargestCoordinate` (scene/transform_points.h); `kInvalidId` if there is none. O(vertices).
  [[nodiscard]] std::uint32_t place(const Executor& executor, View<const std::uint32_t> numbers);

  [[nodiscard]] View<const PlacedInstance> instances() const {
    return View<const PlacedInstance>(instances_);
  }
  /// One for each instance, in the same order, numbered from 0 without gaps if there are few enough
  /// triangles.
  [[nodiscard]] View<const TriangleRun> runs() const { return View<const TriangleRun>(runs_); }
  /// The triangles of all runs.
  [[nodiscard]] std::uint64_t triangle_count() const { return triangle_count_; }
  /// Whether the triangles can be numbered by 32 bits. Others are met only where the instances
  /// stand (levels/level_scene.h).
  [[nodiscard]] bool fits() const { return triangle_count_ <= kMostPlacedTriangles; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  void settle(std::size_t number) {
    instances_[number].mirrored = mirrors(instances_[number].to_world);
    runs_[number].triangles = instances_[number].triangles;
    point(number);
  }
  /// Points the run to where its vertices are.
  void point(std::size_t number) {
    const PlacedInstance& instance = instances_[number];
    runs_[number].positions =
        instance.is_identity() ? instance.positions.data : world_[number].data();
  }

  std::vector<PlacedInstance> instances_;
  std::vector<TriangleRun> runs_;
  std::vector<Buffer<Vec3>> world_;  ///< vertices of the instances that are not where their mesh is
  std::vector<std::uint8_t> waits_;  ///< for each instance: its vertices are to be placed
  std::uint64_t waiting_ = 0;        ///< their triangles
  std::uint64_t triangle_count_ = 0;
};

/// The boxes of the corners of these runs, in their order. No coordinate is -0. O(triangles).
[[nodiscard]] std::vector<Box> boxes_of(const Executor& executor, View<const TriangleRun> runs);

}  // namespace raysheaf
