#include "render/frame/dual_tracer.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "exec/stopwatch.h"
#include "render/device/frame_stages.h"

namespace raysheaf {
namespace {

/// Fewer rays of one light than this share a query with their neighbours: a separate query costs
/// about as much as tracing them.
constexpr std::size_t kFewestRaysOfALight = 512;

/// Whether the first and the last ray start at one point, which holds for all rays of a point
/// light.
bool starts_at_one_point(View<const Ray> rays) {
  return std::memcmp(&rays[0].origin, &rays[rays.size - 1].origin, sizeof(Vec3)) == 0;
}

}  // namespace

std::vector<std::size_t> query_ends(const RayBatch& batch) {
  const std::size_t count = batch.rays.size();
  std::vector<std::size_t> ends{0};
  std::vector<std::uint32_t> light_ends = batch.light_ends;
  if (light_ends.empty()) light_ends.push_back(static_cast<std::uint32_t>(count));
  bool joins = false;  // the last query takes further rays
  std::size_t begin = 0;
  for (const std::uint32_t end : light_ends) {
    if (begin == end) continue;
    const View<const Ray> rays = View<const Ray>(batch.rays).slice(begin, end - begin);
    const bool alone = rays.size >= kFewestRaysOfALight && starts_at_one_point(rays);
    if (joins && !alone) ends.pop_back();
    ends.push_back(end);
    joins = !alone;
    begin = end;
  }
  return ends;
}

void DualTracer::update(const FlatScene& scene, const FlatUpdate& update) {
  if (!update.same_triangles) return engine_.set_triangles(scene.source(), false);
  std::vector<TriangleRange> moved;
  for (const std::uint32_t i : update.placed_meshes)
    moved.push_back({scene.meshes[i].first_triangle, scene.meshes[i].triangle_count});
  engine_.move_triangles(scene.source(), moved);
}

QueryReport DualTracer::prepare_tree(const Executor& executor) {
  QueryReport report;
  engine_.prepare_tree(executor, &report);
  tree_.add({true, report.tree, report.hierarchy_ms});
  return report;
}

/// `whole`: the report covers all rays of the batch, not a part of them.
void DualTracer::add_report(const QueryReport& report, std::size_t rays, bool whole,
                            BatchStatistics* statistics) {
  tree_.add({report.used_tree, report.tree, report.used_tree ? report.hierarchy_ms : 0});
  add_engine_report(report, whole ? 0 : rays, statistics);
}

void DualTracer::find_occluded(const Executor& executor, const RayBatch& batch, Facing facing,
                               BatchStatistics* statistics, View<float> ray_tests,
                               View<std::uint8_t> occluded) {
  const std::vector<std::size_t> ends = query_ends(batch);
  for (std::size_t q = 0; q + 1 < ends.size(); ++q) {
    const std::size_t begin = ends[q], count = ends[q + 1] - begin;
    const PlannedOptions options =
        counting_options(facing, ray_tests.empty() ? ray_tests : ray_tests.slice(begin, count));
    QueryReport report;
    engine_.any_hit(executor, RaysInPlace(View<const Ray>(batch.rays).slice(begin, count)), options,
                    occluded.slice(begin, count), &report);
    add_report(report, count, ends.size() == 2 && !batch.part, statistics);
  }
}

void DualTracer::find_closest(const Executor& executor, const RayBatch& batch,
                              const PlannedOptions& options, BatchStatistics* statistics,
                              View<RayHit> hits) {
  QueryReport report;
  const auto take = [&](std::size_t begin, View<const IndexedHit> found) {
    for (std::size_t i = 0; i < found.size; ++i) hits[begin + i] = {found[i].t, found[i].triangle};
  };
  engine_.closest_hit(executor, RaysInPlace(batch.rays), options, take, &report);
  add_report(report, batch.rays.size(), !batch.part, statistics);
}

std::vector<RayHit> DualTracer::trace(const Executor& executor, const RayBatch& batch,
                                      Facing facing, BatchStatistics* statistics,
                                      View<float> ray_tests) {
  std::vector<RayHit> hits(batch.rays.size());
  if (!asks_occlusion(batch)) {
    find_closest(executor, batch, counting_options(facing, ray_tests), statistics, hits);
    return hits;
  }
  occluded_.resize_uninitialized(hits.size());
  find_occluded(executor, batch, facing, statistics, ray_tests, occluded_);
  executor.for_each(hits.size(), kCopyGrain, [&](std::size_t i) {
    if (occluded_[i] != 0) hits[i] = {0, kSomeTriangle};
  });
  return hits;
}

}  // namespace raysheaf
