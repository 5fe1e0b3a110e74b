#include "render/frame/trace.h"

#include <algorithm>

#include "exec/stopwatch.h"
#include "render/frame/brute_force.h"
#include "render/frame/shared_trace.h"

namespace raysheaf {
namespace {

/// Every ray with every triangle.
std::vector<RayHit> trace_brute_force(const Executor& executor, const FlatScene& scene,
                                      const RayBatch& batch, const TraceOptions& options,
                                      BatchStatistics* statistics, View<float> ray_tests,
                                      ProgressMeter* meter) {
  Stopwatch watch;
  meter->begin(stage_name(batch.kind, batch.bounce), batch.rays.size());
  std::vector<RayHit> hits(batch.rays.size());
  intersect_brute_force(executor, scene.source(), batch.rays, options.facing, hits, meter);
  for (float& tests : ray_tests) tests += static_cast<float>(scene.triangle_count);
  statistics->final_tests += std::uint64_t{scene.triangle_count} * batch.rays.size();
  statistics->times_ms.intersect += watch.lap_ms();
  return hits;
}

std::vector<RayHit> trace_ordered(const Executor& executor, const FlatScene& scene,
                                  const RayBatch& batch, const TraceOptions& options,
                                  BatchStatistics* statistics, View<float> ray_tests,
                                  ProgressMeter* meter) {
  BatchTracer& tracer = options.cache->ordered_tracer();
  std::vector<RayHit> hits =
      tracer.trace(executor, scene, batch, options, statistics, ray_tests, meter);
  options.cache->tree.add(tracer.take_tree_report());
  return hits;
}

std::vector<RayHit> trace_dual(const Executor& executor, const FlatScene& scene,
                               const RayBatch& batch, const TraceOptions& options,
                               BatchStatistics* statistics, View<float> ray_tests,
                               ProgressMeter* meter) {
  Stopwatch watch;
  meter->begin(stage_name(batch.kind, batch.bounce), 1);
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

using TraceFunction = decltype(&trace_ordered);

TraceFunction function_of(Traversal traversal) {
  switch (traversal) {
    case Traversal::kBruteForce:
      return trace_brute_force;
    case Traversal::kRayHierarchy:
    case Traversal::kPackets:
      return trace_ordered;
    case Traversal::kDual:
      break;
  }
  return trace_dual;
}

}  // namespace

BatchTracer& TraceCache::ordered_tracer() {
  if (ordered == nullptr) ordered = batch_tracers().on_cpu();
  return *ordered;
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

void TraceCache::update(const Executor& executor, const FlatScene& scene,
                        const FlatUpdate& update) {
  if (update.same_triangles && update.placed_meshes.empty()) return;
  if (ordered != nullptr) ordered->update(executor, scene, update);
  if (device != nullptr) device->forget_scene(update.same_triangles);
  if (stages != nullptr) stages->forget_scene(update);
  if (dual != nullptr) dual->update(scene, update);
}

void TraceCache::forget_places() {
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
    meter->begin(stage_name(batch.kind, batch.bounce), 1);
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
