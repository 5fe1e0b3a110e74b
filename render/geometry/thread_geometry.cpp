#include "render/geometry/thread_geometry.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "exec/stopwatch.h"

namespace raysheaf {
namespace {

void add_part(const QueryReport& report, std::size_t rays, BatchStatistics* statistics) {
  add_engine_report(report, rays, statistics);
  statistics->rays += rays;
}

}  // namespace

Fragments ThreadGeometry::first_hits(std::size_t group, const FirstHitTally& tally) {
  if (seen_.known[group] == 0) find_first_hits(seen_.groups[group], tally);
  seen_.known[group] = 1;
  return FlatGeometry::first_hits(group, tally);
}

void ThreadGeometry::find_first_hits(const PixelGroup& pixels, const FirstHitTally& tally) {
  Stopwatch watch;
  RayBatch batch = primary_rays(serial_, scene_.bounds, seen_.rays, pixels, Keys::kNone);
  batch.part = true;
  batch.tells_plan = tally.tells_plan;
  BatchStatistics& statistics = tally.statistics();
  statistics.times_ms.raygen += watch.lap_ms();
  std::vector<float> tests(seen_.pixel_tests.empty() ? 0 : pixels.count);
  const std::vector<RayHit> hits =
      traced(batch, Facing::kSkipBackOfSingleSided, &statistics, tests, nullptr);
  for (std::size_t i = 0; i < hits.size(); ++i) note_seen(pixels.pixel(i), hits[i].triangle);
  for (std::size_t i = 0; i < tests.size(); ++i) seen_.pixel_tests[pixels.pixel(i)] += tests[i];
}

std::vector<RayHit> ThreadGeometry::meet(const RayBatch& batch, Facing facing,
                                         BatchStatistics* statistics, View<float> ray_tests,
                                         ProgressMeter* /*meter*/) {
  if (levels_ != nullptr) return enter(batch, facing, statistics);
  std::vector<RayHit> hits(batch.rays.size());
  closest_.resize_uninitialized(hits.size());
  QueryReport report;
  queries_.closest_hit(cache_.dual->engine(), batch.rays, counting_options(facing),
                       batch.tells_plan, closest_, ray_tests, &report);
  add_part(report, hits.size(), statistics);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    hits[i] = {closest_[i].t, closest_[i].triangle};
    statistics->hits += hits[i].found() ? 1 : 0;
  }
  return hits;
}

void ThreadGeometry::meet_any(const RayBatch& batch, bool /*early_out*/,
                              BatchStatistics* statistics, View<float> ray_tests,
                              ProgressMeter* /*meter*/, View<std::uint8_t> occluded) {
  if (levels_ != nullptr) return enter_any(batch, statistics, occluded);
  QueryReport report;
  queries_.any_hit(cache_.dual->engine(), batch.rays, counting_options(Facing::kBoth),
                   batch.tells_plan, occluded, ray_tests, &report);
  add_part(report, batch.rays.size(), statistics);
  statistics->hits += std::accumulate(occluded.begin(), occluded.end(), std::uint64_t{0});
}

}  // namespace raysheaf
