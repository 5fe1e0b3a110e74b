// Instances of meshes in world space, as runs of numbered triangles: what the scene of ray queries
// and that of the renderer have in common.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/buffer.h"
#include "base/mirrors_body.h"
#include "raysheaf/types.h"
#include "scene/triangle_source.h"

namespace raysheaf {

class Executor;

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
  bool mirrored = false;  ///< the transform turns the winding; found by `PlacedRuns`

  [[nodiscard]] bool is_identity() const { return to_world.m == Affine().m; }
};

/// The runs of a list of instances. Instances with the identity transform share the vertices of
/// their mesh; every other instance has its vertices here, in world space.
class PlacedRuns {
 public:
  /// Sets the list, ascending by (geom_id, inst_id), with fewer than 2^31 triangles in all.
  /// Instances that were in the former list keep their vertices; `place` those that are new or have
  /// changed. O(instances).
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
  /// Places the instances that wait. O(their vertices).
  void place_waiting(const Executor& executor);
  [[nodiscard]] bool is_waiting() const { return waiting_ != 0; }
  [[nodiscard]] std::uint64_t waiting_triangles() const { return waiting_; }
  /// Transforms the vertices of the instances of these numbers (no number twice). Returns the least
  /// `inst_id` of an instance that puts a vertex of a triangle farther out than
  /// `kLargestCoordinate` (scene/transform_points.h); `kInvalidId` if there is none. O(vertices).
  [[nodiscard]] std::uint32_t place(const Executor& executor, View<const std::uint32_t> numbers);

  [[nodiscard]] View<const PlacedInstance> instances() const {
    return View<const PlacedInstance>(instances_);
  }
  /// One for each instance, in the same order, numbered from 0 without gaps.
  [[nodiscard]] View<const TriangleRun> runs() const { return View<const TriangleRun>(runs_); }
  /// The triangles of all runs.
  [[nodiscard]] std::uint32_t triangle_count() const {
    return runs_.empty() ? 0 : runs_.back().first + runs_.back().count;
  }
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
};

/// The boxes of the corners of these runs, in their order. No coordinate is -0. O(triangles).
[[nodiscard]] std::vector<Box> boxes_of(const Executor& executor, View<const TriangleRun> runs);

}  // namespace raysheaf
