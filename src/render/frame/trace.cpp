#include "render/frame/trace.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "exec/radix_sort.h"
#include "exec/stopwatch.h"
#include "intersect/brute_force.h"
#include "methods/packets/packet_traverse.h"
#include "methods/ray_hierarchy/hierarchy.h"
#include "methods/ray_hierarchy/traverse.h"
#include "rays/keys.h"
#include "rays/order/order.h"
#include "render/frame/bundles.h"
#include "render/frame/shared_trace.h"

namespace raysheaf {
namespace {

std::string stage_name(const RayBatch& batch) {
  return std::string(to_string(batch.kind)) + " rays, bounce " + std::to_string(batch.bounce);
}

void add_outcome(const TraverseCounts& counts, double wall_ms, BatchStatistics* statistics) {
  add_counts(counts, statistics);
  // Both stages run in one pass: its wall time is divided in proportion to the threads' times.
  const double sum = counts.node_seconds + counts.final_seconds;
  const double part = sum > 0 ? counts.final_seconds / sum : 0;
  statistics->times_ms.traverse += wall_ms * (1 - part);
  statistics->times_ms.intersect += wall_ms * part;
}

/// Every ray with every triangle.
std::vector<RayHit> trace_brute_force(const Executor& executor, const FlatScene& scene,
                                      const RayBatch& batch, const TraceOptions& options,
                                      BatchStatistics* statistics, View<float> ray_tests,
                                      ProgressMeter* meter) {
  Stopwatch watch;
  meter->begin(stage_name(batch), batch.rays.size());
  std::vector<RayHit> hits(batch.rays.size());
  intersect_brute_force(executor, options.cache->triangles(executor, scene), batch.rays,
                        options.facing, hits, meter);
  for (float& tests : ray_tests) tests += static_cast<float>(scene.triangle_count);
  statistics->final_tests += std::uint64_t{scene.triangle_count} * batch.rays.size();
  statistics->times_ms.intersect += watch.lap_ms();
  return hits;
}

/// The number of runs of equal keys.
std::uint64_t run_count(const std::vector<std::uint64_t>& keys) {
  std::uint64_t runs = keys.empty() ? 0 : 1;
  for (std::size_t i = 1; i < keys.size(); ++i) runs += keys[i] != keys[i - 1] ? 1 : 0;
  return runs;
}

std::vector<RayHit> trace_hierarchy(const Executor& executor, const FlatScene& scene,
                                    const RayBatch& batch, const TraceOptions& options,
                                    BatchStatistics* statistics, View<float> ray_tests,
                                    ProgressMeter* meter) {
  const MethodSettings& method = options.method;
  const TriangleView triangles = options.cache->triangles(executor, scene);
  StageTimes& times = statistics->times_ms;
  Stopwatch watch;
  const std::vector<std::uint32_t> order =
      ray_order(executor, batch, scene.bounds, method, statistics);
  std::vector<Ray> rays(order.size());
  executor.for_each(order.size(), kCopyGrain,
                    [&](std::size_t i) { rays[i] = batch.rays[order[i]]; });
  times.order += watch.lap_ms();

  TraverseOptions traversal;
  traversal.mesh_culling = method.mesh_culling;
  traversal.early_out = options.early_out;
  traversal.facing = options.facing;
  std::vector<RayHit> best(order.size());
  std::vector<float> tests(ray_tests.empty() ? 0 : order.size());
  const TraverseCounts counts =
      with_bound(method.bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
        const RayHierarchy<Bound> tree =
            build_hierarchy<Bound>(executor, rays, scene.bounds, method.branching, method.levels);
        times.hierarchy += watch.lap_ms();
        sample_bundles(executor, triangles, tree, rays, options.bundle_samples,
                       &statistics->bundles);
        watch.lap_ms();
        meter->begin(stage_name(batch), tree.level(tree.top()).size());
        return traverse(executor, triangles, View<const FlatMesh>(scene.meshes), tree, rays,
                        traversal, best, tests, meter);
      });
  add_outcome(counts, watch.lap_ms(), statistics);

  std::vector<RayHit> hits(order.size());
  executor.for_each(order.size(), kCopyGrain, [&](std::size_t i) {
    hits[order[i]] = best[i];
    if (!tests.empty()) ray_tests[order[i]] += tests[i];
  });
  times.order += watch.lap_ms();
  return hits;
}

/// Packets have their own `levels` and `branching`.
std::vector<RayHit> trace_packets(const Executor& executor, const FlatScene& scene,
                                  const RayBatch& batch, const TraceOptions& options,
                                  BatchStatistics* statistics, View<float> ray_tests,
                                  ProgressMeter* meter) {
  const TriangleView triangles = options.cache->triangles(executor, scene);
  StageTimes& times = statistics->times_ms;
  Stopwatch watch;
  std::vector<std::uint32_t> order =
      ray_order(executor, batch, scene.bounds, options.method, statistics);
  std::vector<std::uint32_t> keys;
  if (options.method.key == RayKey::kCrsh) {
    keys.resize(order.size());
    executor.for_each(order.size(), kCopyGrain,
                      [&](std::size_t i) { keys[i] = batch.keys[order[i]]; });
  }
  times.order += watch.lap_ms();

  const Bvh& bvh = options.cache->hierarchy(executor, scene);
  const std::vector<Packet> packets =
      make_packets(executor, batch.rays, keys, batch.key_bits, kPacketRays, order);
  times.hierarchy += watch.lap_ms();

  std::vector<Ray> rays(order.size());
  executor.for_each(order.size(), kCopyGrain,
                    [&](std::size_t i) { rays[i] = batch.rays[order[i]]; });
  times.order += watch.lap_ms();

  sample_bundles(executor, triangles, packets, rays, options.bundle_samples, &statistics->bundles);
  meter->begin(stage_name(batch), packets.size());
  PacketOptions traversal;
  traversal.early_out = options.early_out;
  traversal.facing = options.facing;
  std::vector<RayHit> best(order.size());
  std::vector<float> tests(ray_tests.empty() ? 0 : order.size());
  const PacketCounts counts =
      traverse_packets(executor, triangles, bvh, packets, rays, traversal, best, tests, meter);
  add_counts(counts, statistics);
  times.hierarchy += 1e3 * counts.packet_seconds;
  times.traverse += 1e3 * counts.traverse_seconds;
  times.intersect += 1e3 * counts.final_seconds;

  watch.lap_ms();
  std::vector<RayHit> hits(order.size());
  executor.for_each(order.size(), kCopyGrain, [&](std::size_t i) {
    hits[order[i]] = best[i];
    if (!tests.empty()) ray_tests[order[i]] += tests[i];
  });
  times.order += watch.lap_ms();
  return hits;
}

std::vector<RayHit> trace_dual(const Executor& executor, const FlatScene& scene,
                               const RayBatch& batch, const TraceOptions& options,
                               BatchStatistics* statistics, View<float> ray_tests,
                               ProgressMeter* meter) {
  Stopwatch watch;
  meter->begin(stage_name(batch), 1);
  DualTracer& tracer = options.cache->dual_tracer(scene);
  statistics->times_ms.hierarchy += watch.lap_ms();
  std::vector<RayHit> hits = tracer.trace(executor, batch, options.facing, statistics, ray_tests);
  options.cache->tree.add(tracer.take_tree_report());
  return hits;
}

bool runs_on_device(const TraceOptions& options) {
  return options.cache != nullptr && options.cache->backend != nullptr;
}

std::uint64_t hits_among(const std::vector<RayHit>& hits) {
  return static_cast<std::uint64_t>(
      std::count_if(hits.begin(), hits.end(), [](const RayHit& hit) { return hit.found(); }));
}

using TraceFunction = decltype(&trace_packets);

TraceFunction function_of(Traversal traversal) {
  switch (traversal) {
    case Traversal::kBruteForce:
      return trace_brute_force;
    case Traversal::kRayHierarchy:
      return trace_hierarchy;
    case Traversal::kPackets:
      return trace_packets;
    case Traversal::kDual:
      break;
  }
  return trace_dual;
}

}  // namespace

std::vector<std::uint32_t> ray_order(const Executor& executor, const RayBatch& batch,
                                     const Box& scene_bounds, const MethodSettings& method,
                                     BatchStatistics* statistics) {
  std::vector<std::uint32_t> order(batch.rays.size());
  if (method.key == RayKey::kCrsh) {
    statistics->chunks += order_by_key(executor, batch.keys, order, batch.key_bits);
    return order;
  }
  std::iota(order.begin(), order.end(), 0u);
  if (method.key == RayKey::kRaster) return order;
  std::uint32_t used_bits = 0;
  std::vector<std::uint64_t> keys =
      make_keys(executor, batch, method.key, method.key_bits, scene_bounds, &used_bits);
  if (used_bits > 32) {
    statistics->chunks += run_count(keys);
    radix_sort_pairs(executor, keys, order, used_bits);
    return order;
  }
  std::vector<std::uint32_t> low(keys.size());
  executor.for_each(keys.size(), kCopyGrain,
                    [&](std::size_t i) { low[i] = static_cast<std::uint32_t>(keys[i]); });
  statistics->chunks += order_by_key(executor, low, order, used_bits);
  return order;
}

TriangleView TraceCache::triangles(const Executor& executor, const FlatScene& scene) {
  if (!arrays) arrays.emplace(executor, scene);
  return arrays->view();
}

DeviceTracer& TraceCache::device_tracer(const FlatScene& scene) {
  if (device == nullptr) device = std::make_unique<DeviceTracer>(scene, *backend);
  return *device;
}

DualTracer& TraceCache::dual_tracer(const FlatScene& scene) {
  if (!dual) dual = std::make_unique<DualTracer>(scene);
  return *dual;
}

QueryReport TraceCache::prepare_tree(const Executor& executor, const FlatScene& scene) {
  Stopwatch watch;
  DualTracer& tracer = dual_tracer(scene);
  QueryReport report = tracer.prepare_tree(executor);
  tree.add(tracer.take_tree_report());
  report.hierarchy_ms = watch.lap_ms();
  return report;
}

const Bvh& TraceCache::hierarchy(const Executor& executor, const FlatScene& scene) {
  tree.add({true, TreeWork::kKeep, 0});
  if (!bvh) {
    Stopwatch build;
    bvh = build_bvh(executor, triangles(executor, scene));
    tree.add({true, TreeWork::kRebuild, build.lap_ms()});
  }
  return *bvh;
}

void TraceCache::update(const Executor& executor, const FlatScene& scene,
                        const FlatUpdate& update) {
  if (update.same_triangles && update.placed_meshes.empty()) return;
  bvh.reset();
  if (!update.same_triangles) arrays.reset();
  if (arrays) arrays->move(executor, scene, View<const std::uint32_t>(update.placed_meshes));
  if (device != nullptr) device->forget_scene(update.same_triangles);
  if (stages != nullptr) stages->forget_scene(update);
  if (dual != nullptr) dual->update(scene, update);
}

void TraceCache::forget_places() {
  bvh.reset();
  if (device != nullptr) device->forget_scene(true);
}

std::vector<RayHit> trace(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                          const TraceOptions& wanted, BatchStatistics* statistics,
                          View<float> ray_tests, ProgressMeter* meter) {
  TraceCache own;
  TraceOptions options = wanted;
  if (options.cache == nullptr) options.cache = &own;
  statistics->kind = batch.kind;
  statistics->bounce = batch.bounce;
  statistics->triangles = scene.triangle_count;
  statistics->rays += batch.rays.size();
  if (batch.rays.empty()) return {};
  // Frames on a device do not come here; this is a ray before the frame.
  if (runs_on_device(options)) {
    meter->begin(stage_name(batch), 1);
    std::vector<RayHit> hits =
        options.cache->device_tracer(scene).trace(executor, batch, options.facing);
    statistics->hits += hits_among(hits);
    return hits;
  }
  const TraceFunction method = function_of(options.method.traversal);
  const auto trace_all = [&](const RayBatch& rays, BatchStatistics* counted, View<float> tests,
                             ProgressMeter* progress) {
    return method(executor, scene, rays, options, counted, tests, progress);
  };
  Communicator* const ranks = sharers(options.cache->ranks, batch);
  std::vector<RayHit> hits =
      ranks != nullptr ? trace_shared(*ranks, batch, statistics, ray_tests, meter, trace_all)
                       : trace_all(batch, statistics, ray_tests, meter);
  statistics->hits += hits_among(hits);
  return hits;
}

bool asks_alone(const TraceOptions& options) {
  return options.method.traversal == Traversal::kDual && !runs_on_device(options);
}

}  // namespace raysheaf
