#include "frame/device_tracer.h"

#include "frame/dual_tracer.h"

namespace raysheaf {
namespace {

constexpr std::size_t kGrain = 4096;

void add_report(EngineReport report, BatchStatistics* statistics) {
  statistics->bound_tests += report.bound_tests;
  statistics->ray_bound_tests += report.ray_bound_tests;
  statistics->final_tests += report.triangle_tests;
  statistics->times_ms.order += report.order_ms;
  statistics->times_ms.hierarchy += report.hierarchy_ms;
  statistics->times_ms.traverse += report.trace_ms;
  for (std::string& sentence : report.plan) statistics->plan.push_back(std::move(sentence));
}

}  // namespace

DeviceTracer::DeviceTracer(const Executor& executor, const FlatScene& scene,
                           const DeviceBackend& backend)
    : engine_(backend.make_engine()) {
  const std::uint32_t count = scene.triangle_count;
  Buffer<Vec3> corners;
  corners.resize_uninitialized(std::size_t{3} * count);
  executor.for_each(count, kGrain, [&](std::size_t i) {
    for (int k = 0; k < 3; ++k)
      corners[3 * i + static_cast<std::size_t>(k)] = scene.corner(static_cast<std::uint32_t>(i), k);
  });
  const TriangleRun run{corners.data(), nullptr, 0, count};
  TriangleSource source;
  source.runs = {&run, count > 0 ? std::size_t{1} : std::size_t{0}};
  source.count = count;
  source.flags = scene.flags.data();
  engine_->set_triangles(executor, source);
}

std::vector<RayHit> DeviceTracer::trace(const Executor& executor, const RayBatch& batch,
                                        Facing facing, bool brute, BatchStatistics* statistics,
                                        View<float> ray_tests) {
  const View<const Ray> rays(batch.rays);
  EngineReport report;
  std::vector<float> tests(ray_tests.size);
  DeviceQuery query;
  query.facing = facing;
  query.brute = brute;
  query.count = true;
  query.report = &report;
  query.ray_tests = View<float>(tests);
  std::vector<RayHit> hits(rays.size);
  if (!brute && asks_occlusion(batch.kind)) {
    occluded_.resize_uninitialized(rays.size);
    engine_->any_hit(rays, query, View<std::uint8_t>(occluded_));
    executor.for_each(hits.size(), kGrain, [&](std::size_t i) {
      if (occluded_[i] != 0) hits[i] = {0, kSomeTriangle};
    });
  } else {
    closest_.resize_uninitialized(rays.size);
    engine_->closest_hit(rays, query, View<EngineHit>(closest_));
    executor.for_each(hits.size(), kGrain, [&](std::size_t i) {
      hits[i] = {closest_[i].t, closest_[i].triangle};
    });
  }
  for (std::size_t i = 0; i < tests.size(); ++i) ray_tests[i] += tests[i];
  add_report(std::move(report), statistics);
  return hits;
}

}  // namespace raysheaf
