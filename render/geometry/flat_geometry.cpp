#include "render/geometry/flat_geometry.h"

#include <algorithm>
#include <numeric>

#include "exec/stopwatch.h"
#include "levels/trace_levels.h"
#include "queries/level_way.h"

namespace raysheaf {
namespace {

void count_entered(const DualCounts& counts, std::size_t rays, std::uint64_t hits, double ms,
                   BatchStatistics* statistics) {
  QueryReport report;
  report.add(counts);
  report.lap(&QueryReport::trace_ms, ms);
  add_engine_report(report, 0, statistics);
  statistics->rays += rays;
  statistics->hits += hits;
}

}  // namespace

Fragments FlatGeometry::first_hits(std::size_t group, const FirstHitTally& /*tally*/) {
  return fetch_fragments(executor_, source_, seen_.rays, seen_.triangles, seen_.groups[group]);
}

std::vector<RayHit> FlatGeometry::traced(const RayBatch& batch, Facing facing,
                                         BatchStatistics* statistics, View<float> ray_tests,
                                         ProgressMeter* meter) {
  met_.clear();
  const auto first_hits = [&](const RayBatch& rays, View<float> tests) {
    return meet(rays, facing, statistics, tests, meter);
  };
  std::vector<RayHit> hits = first_hits(batch, ray_tests);
  if (cutouts_.any()) cutouts_.pass(batch, first_hits, hits, ray_tests);
  return hits;
}

std::vector<RayHit> FlatGeometry::trace(const RayBatch& batch, BatchStatistics* statistics,
                                        View<float> ray_tests, ProgressMeter* meter) {
  return traced(batch, Facing::kBoth, statistics, ray_tests, meter);
}

void FlatGeometry::find_occluded(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                                 View<float> ray_tests, ProgressMeter* meter,
                                 View<std::uint8_t> occluded) {
  meet_any(batch, early_out, statistics, ray_tests, meter, occluded);
  if (!cutouts_.any()) return;
  // Rays that something stops; if its triangle has holes, the closest hit must be found to know.
  std::vector<std::uint32_t> stopped;
  for (std::uint32_t i = 0; i < occluded.size; ++i)
    if (occluded[i] != 0) stopped.push_back(i);
  if (stopped.empty()) return;
  RayBatch rays = part_of(batch, stopped);
  rays.names_hits = true;
  std::vector<float> tests(ray_tests.empty() ? 0 : stopped.size());
  const std::vector<RayHit> hits = traced(rays, Facing::kBoth, statistics, tests, meter);
  for (std::size_t i = 0; i < stopped.size(); ++i) {
    occluded[stopped[i]] = hits[i].found() ? 1 : 0;
    if (!tests.empty()) ray_tests[stopped[i]] += tests[i];
  }
}

void FlatGeometry::fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) {
  executor_.for_each_block(fragments.size, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    SurfaceFetcher fetcher(source_);
    for (std::size_t first = begin; first < end; first += kFetchedTogether) {
      const std::size_t count = std::min(kFetchedTogether, end - first);
      fetcher.fetch(rays.slice(first, count), Arrival::kTraced, fragments.slice(first, count));
    }
  });
}

PixelIds FlatGeometry::ids(std::uint32_t triangle) const {
  return triangle != kInvalidId ? ids_of(scene_, source_.at(triangle)) : PixelIds{};
}

void FlatGeometry::note_seen(std::size_t pixel, std::uint32_t triangle) {
  if (levels_ != nullptr && triangle != kInvalidId) {
    seen_.met[pixel] = met_.at(triangle);
    triangle = static_cast<std::uint32_t>(pixel);
  }
  seen_.triangles[pixel] = triangle;
}

std::vector<RayHit> FlatGeometry::enter(const RayBatch& batch, Facing facing,
                                        BatchStatistics* statistics) {
  const Stopwatch watch;
  std::vector<Hit> found(batch.rays.size());
  DualCounts counts;
  trace_levels(executor_, *levels_, batch.rays, {.facing = facing}, {.hits = found}, &counts,
               plan_level_way(RaysInPlace(batch.rays)));
  std::vector<RayHit> hits(found.size());
  std::uint64_t met = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (found[i].prim_id == kInvalidId) continue;
    hits[i] = {found[i].t, met_.add({found[i].inst_id, found[i].prim_id})};
    ++met;
  }
  count_entered(counts, hits.size(), met, watch.ms(), statistics);
  return hits;
}

void FlatGeometry::enter_any(const RayBatch& batch, BatchStatistics* statistics,
                             View<std::uint8_t> occluded) {
  const Stopwatch watch;
  DualCounts counts;
  trace_levels(executor_, *levels_, batch.rays, {}, {.occluded = occluded}, &counts,
               plan_level_way(RaysInPlace(batch.rays)));
  count_entered(counts, occluded.size,
                std::accumulate(occluded.begin(), occluded.end(), std::uint64_t{0}), watch.ms(),
                statistics);
}

}  // namespace raysheaf
