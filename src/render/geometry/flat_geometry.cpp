#include "render/geometry/flat_geometry.h"

#include <algorithm>

namespace raysheaf {

Fragments FlatGeometry::first_hits(std::size_t group, const FirstHitTally& /*tally*/) {
  return fetch_fragments(executor_, source_, seen_.rays, seen_.triangles, seen_.groups[group]);
}

std::vector<RayHit> FlatGeometry::traced(const RayBatch& batch, Facing facing,
                                         BatchStatistics* statistics, View<float> ray_tests,
                                         ProgressMeter* meter) {
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
  return ids_of(scene_, triangle);
}

}  // namespace raysheaf
