#include "lab/walk_counts.h"

#include <algorithm>
#include <numeric>

#include "device/walks_device.h"
#include "lab/device_bench.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

/// Counts of threads, by the threads' numbers.
struct ThreadCounts {
  std::vector<std::uint32_t> nodes, leaves, triangles, turns;
  std::vector<std::uint8_t> hits;

  explicit ThreadCounts(std::size_t count)
      : nodes(count), leaves(count), triangles(count), turns(count), hits(count) {}
};

ThreadCounts count_threads(EmulatedDevice& device, const DeviceBatch& batch, bool any) {
  ThreadCounts counted(batch.rays.size);
  const auto trees = trees_of<TriangleTree>(batch, 0);
  device.for_each("count", batch.rays.size, [&](std::size_t i) {
    const Ray& ray = batch.rays[batch.ray_at(i)];
    WalkCounts walk;
    const auto found =
        any ? any_in_floats(trees, ray, &walk) : closest_in_floats(trees, ray, &walk);
    IndexedHit best;
    bool sure = !found.unsure;
    for (const TriangleTree::Place place : {found.first, found.second, found.place})
      sure = meet_in_doubles(trees, place, ray, &best) && sure;
    if (!sure && !(any && found.place.triangle != kInvalidId))
      best.triangle = any ? (any_in_tree(trees, ray, &walk) ? 0 : kInvalidId)
                          : closest_in_tree(trees, ray, &walk).triangle;
    counted.hits[i] = best.triangle != kInvalidId;
    counted.nodes[i] = walk.box_tests / 2;
    counted.leaves[i] = walk.leaves;
    counted.triangles[i] = walk.triangle_tests;
    counted.turns[i] = counted.nodes[i] + counted.leaves[i];
  });
  return counted;
}

template <class T>
std::uint64_t sum_of(const std::vector<T>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::vector<Vec3> corners_of(const Executor& executor, const SceneDescription& scene) {
  const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
  std::vector<Vec3> corners;
  corners.reserve(std::size_t{3} * flat.triangle_count);
  for (std::uint32_t i = 0; i < flat.triangle_count; ++i)
    for (const Vec3 corner : flat.corners(i)) corners.push_back(corner);
  return corners;
}

}  // namespace

std::uint64_t warp_turns(View<const std::uint32_t> turns_of_threads) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < turns_of_threads.size; i += kWarpThreads) {
    const std::size_t end = std::min(i + kWarpThreads, turns_of_threads.size);
    sum += *std::max_element(turns_of_threads.data + i, turns_of_threads.data + end);
  }
  return sum;
}

DeviceWalks count_walks_on(EmulatedDevice& device, const TriangleList& list, View<const Ray> rays,
                           bool any) {
  DeviceWalks walks;
  walks.count = rays.size;
  if (rays.empty()) return walks;
  LinearTree tree(device.allocator());
  tree.build(device, list);
  DeviceBatch batch;
  batch.rays = rays;
  batch.tree = tree.view();
  batch.scene = tree.scene();
  const ThreadCounts as_made = count_threads(device, batch, any);
  walks.hits = sum_of(as_made.hits);
  walks.nodes = sum_of(as_made.nodes);
  walks.leaves = sum_of(as_made.leaves);
  walks.triangles = sum_of(as_made.triangles);
  walks.warp_turns = warp_turns(as_made.turns);
  SortColumns<std::uint32_t> columns(device.allocator());
  order_rays_on(device, &columns, &batch);
  walks.sorted_warp_turns = warp_turns(count_threads(device, batch, any).turns);
  return walks;
}

DeviceWalksReport count_device_walks(const SceneDescription& scene,
                                     const DeviceBenchOptions& options) {
  Laboratory laboratory(scene, options.width, options.height, options.threads);
  const Executor executor(options.threads);
  HostAllocator memory;
  EmulatedDevice device(executor, memory);
  const std::vector<Vec3> corners = corners_of(executor, scene);
  DeviceWalksReport report;
  report.triangles = corners.size() / 3;
  for (const LabRays kind : kinds_of_rays(options)) {
    const std::vector<Ray> rays = laboratory.rays(kind);
    report.batches.push_back(count_walks_on(device, {corners, {}}, rays, kind == LabRays::kShadow));
    report.batches.back().rays = kind;
  }
  return report;
}

}  // namespace raysheaf
