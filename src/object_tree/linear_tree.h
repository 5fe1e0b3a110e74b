// The object hierarchy of `dual` on a device: built from triangles in the device's memory, and
// refitted when they move.
//
// O(M) work, for a build in addition to the sort of 64-bit keys; 145 bytes of memory per triangle.
// Only `cost` waits for the device.
#pragma once

#include <numeric>

#include "exec/device.h"
#include "object_tree/linear_build_body.h"
#include "object_tree/triangle_list.h"

namespace raysheaf {

/// A tree on a device. Nodes contain every corner of the triangles below them exactly. Triangles
/// without area are included, and skipped when they are tested.
class LinearTree {
 public:
  explicit LinearTree(DeviceAllocator& allocator)
      : scene_(allocator),
        columns_(allocator),
        nodes_(allocator),
        triangles_(allocator),
        parents_(allocator),
        arrived_(allocator),
        surfaces_(allocator) {}

  /// Fewer than 2^31 triangles. If it throws, the tree is empty.
  template <class Device>
  void build(Device& device, const TriangleList& source);
  /// Refits to the same number of triangles at their current positions: nodes and leaves stay,
  /// boxes are recomputed.
  template <class Device>
  void refit(Device& device, const TriangleList& source);
  /// The number of boxes that a ray through the scene's box is expected to intersect (J. Goldsmith,
  /// J. Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", 1987), for a tree that
  /// is built or refitted. 0 if the scene has no surface. Waits.
  template <class Device>
  [[nodiscard]] double cost(Device& device) const;

  [[nodiscard]] LinearTreeView view() const {
    return {nodes_.data(), triangles_.data(), static_cast<std::uint32_t>(triangles_.size())};
  }
  /// The box of all triangles, on the device, valid after a build; NaN without triangles.
  [[nodiscard]] const SharedBox* scene() const { return scene_.data(); }
  [[nodiscard]] std::size_t memory_bytes() const {
    return scene_.capacity_bytes() + columns_.capacity_bytes() + nodes_.capacity_bytes() +
           triangles_.capacity_bytes() + parents_.capacity_bytes() + arrived_.capacity_bytes() +
           surfaces_.capacity_bytes();
  }

 private:
  /// Several sums of surfaces, so that few threads wait for the same one.
  static constexpr std::uint32_t kSurfaceSums = 64;

  DeviceBuffer<SharedBox> scene_;
  SortColumns<std::uint64_t> columns_;
  DeviceBuffer<LinearNode> nodes_;
  DeviceBuffer<LinearTriangle> triangles_;
  DeviceBuffer<std::uint32_t> parents_;  // of nodes, then of leaves
  DeviceBuffer<std::uint32_t> arrived_;  // at nodes; during a build, at borders of runs
  DeviceBuffer<std::uint64_t> surfaces_;
};

template <class Device>
void LinearTree::build(Device& device, const TriangleList& source) {
  const std::uint32_t count = source.count();
  triangles_.resize_uninitialized("hierarchy: triangles", 0);
  scene_.resize_uninitialized("hierarchy: bounds", 1);
  device.fill("hierarchy: bounds", scene_.view(), 0xff);
  if (count == 0) return;
  columns_.resize_uninitialized("hierarchy: keys", count, false);
  nodes_.resize_uninitialized("hierarchy: nodes", count);
  parents_.resize_uninitialized("hierarchy: nodes", std::size_t{2} * count);
  arrived_.resize_uninitialized("hierarchy: boxes", count);
  surfaces_.resize_uninitialized("hierarchy: boxes", kSurfaceSums);

  const Vec3* const corners = source.corners.data;
  SharedBox* const scene = scene_.data();
  device.for_each("hierarchy: bounds", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    enlarge(scene, triangle_box(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]));
  });
  const LinearKeys made_up(count);
  std::uint64_t* const keys = columns_.keys.data();
  device.for_each("hierarchy: keys", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Box box = triangle_box(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
    keys[i] = linear_key(made_up, box_of(*scene), box, static_cast<std::uint32_t>(i));
  });
  // Numbers ascend below the cells: a stable sort by the cells sorts both.
  device.sort_keys("hierarchy: sort", &columns_, {made_up.id_bits, made_up.bits()});

  const std::uint64_t* const sorted = columns_.keys.data();
  const std::uint64_t id_mask = (std::uint64_t{1} << made_up.id_bits) - 1;
  const View<const std::uint8_t> flags = source.flags;
  triangles_.resize_uninitialized("hierarchy: triangles", count);
  LinearTriangle* const triangles = triangles_.data();
  device.for_each("hierarchy: triangles", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const auto id = static_cast<std::uint32_t>(sorted[i] & id_mask);
    const std::size_t at = std::size_t{3} * id;
    const std::uint32_t set = flags.empty() ? 0u : flags.data[id];
    const std::uint32_t ends = i + 1 == count && count <= kLinearLeaf ? 1 : 0;
    triangles[i] = {corners[at], id, corners[at + 1], set, corners[at + 2], ends};
  });
  if (count <= kLinearLeaf) return;
  device.fill("hierarchy: nodes", parents_.view(), 0xff);
  device.fill("hierarchy: nodes", arrived_.view(), 0xff);
  device.fill("hierarchy: nodes", surfaces_.view(), 0);
  const LinearBuild parts{sorted,
                          count,
                          triangles,
                          nodes_.data(),
                          {parents_.data(), parents_.data() + count},
                          arrived_.data(),
                          columns_.spare_keys.data()};
  std::uint64_t* const surfaces = surfaces_.data();
  device.for_each("hierarchy: nodes", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint64_t surface = grow_run(parts, static_cast<std::uint32_t>(i), box_of(*scene));
    if (surface != 0) add_to(&surfaces[i % kSurfaceSums], surface);
  });
}

template <class Device>
void LinearTree::refit(Device& device, const TriangleList& source) {
  device.fill("hierarchy: refit", scene_.view(), 0xff);
  const Vec3* const corners = source.corners.data;
  const View<const std::uint8_t> flags = source.flags;
  SharedBox* const scene = scene_.data();
  LinearTriangle* const triangles = triangles_.data();
  device.for_each("hierarchy: refit", triangles_.size(), [=] RAYSHEAF_DEVICE(std::size_t i) {
    LinearTriangle& t = triangles[i];
    const Vec3* const now = corners + std::size_t{3} * t.id;
    t.a = now[0];
    t.b = now[1];
    t.c = now[2];
    t.flags = flags.empty() ? 0u : flags.data[t.id];
    enlarge(scene, triangle_box(t.a, t.b, t.c));
  });
  const auto count = static_cast<std::uint32_t>(triangles_.size());
  if (count <= kLinearLeaf) return;
  device.fill("hierarchy: boxes", arrived_.view(), 0);
  device.fill("hierarchy: boxes", surfaces_.view(), 0);
  const LinearParents parents{parents_.data(), parents_.data() + count};
  LinearNode* const nodes = nodes_.data();
  std::uint32_t* const arrived = arrived_.data();
  std::uint64_t* const surfaces = surfaces_.data();
  device.for_each("hierarchy: boxes", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint64_t surface =
        fit_boxes(triangles, static_cast<std::uint32_t>(i), *scene, parents, arrived, nodes);
    if (surface != 0) add_to(&surfaces[i % kSurfaceSums], surface);
  });
}

template <class Device>
double LinearTree::cost(Device& device) const {
  if (triangles_.size() <= kLinearLeaf) return 0;
  std::uint64_t sums[kSurfaceSums];
  device.copy("hierarchy: cost", sums, surfaces_.data(), sizeof sums);
  const Box scene = box_of(device.read("hierarchy: cost", scene_.data()));
  const std::uint64_t whole = surface_parts(scene, scene);
  const std::uint64_t all = std::accumulate(sums, sums + kSurfaceSums, std::uint64_t{0});
  return whole != 0 ? static_cast<double>(all) / static_cast<double>(whole) : 0;
}

}  // namespace raysheaf
