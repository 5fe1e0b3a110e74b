#include "api/query_brute.h"

#include <algorithm>

#include "intersect/triangle_body.h"
#include "scene/flatten_body.h"

namespace raysheaf::brute {
namespace {

/// Rays per task.
constexpr std::size_t kBruteGrain = 16;

/// Calls `take(hit)`, which says whether to go on, for the hits of ray `number` by ascending
/// triangle.
template <class Take>
void for_each_hit(const TriangleSource& source, View<const Ray> rays, std::size_t number,
                  const HitFilter* filter, const Take& take) {
  const RaySetup setup = make_ray_setup(rays[number]);
  for (const TriangleRun& run : source.runs) {
    for (std::uint32_t i = 0; i < run.count; ++i) {
      const auto [a, b, c] = run.corners(i);
      TriangleHit hit;
      if (!intersect_triangle(setup, a, b, c, &hit)) continue;
      if (filter != nullptr &&
          !filter->takes(static_cast<std::uint32_t>(number), run.first + i, hit.front))
        continue;
      if (!take(IndexedHit{hit.t, hit.u, hit.v, run.first + i})) return;
    }
  }
}

}  // namespace

void closest_hit(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
                 const HitFilter* filter, View<IndexedHit> hits) {
  executor.for_each(rays.size, kBruteGrain, [&](std::size_t i) {
    IndexedHit best;
    for_each_hit(source, rays, i, filter, [&](const IndexedHit& hit) {
      if (hit.t < best.t || best.triangle == kInvalidId) best = hit;
      return true;
    });
    hits[i] = best;
  });
}

void any_hit(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
             const HitFilter* filter, View<std::uint8_t> occluded) {
  executor.for_each(rays.size, kBruteGrain, [&](std::size_t i) {
    bool met = false;
    for_each_hit(source, rays, i, filter, [&](const IndexedHit&) {
      met = true;
      return false;
    });
    occluded[i] = met ? 1 : 0;
  });
}

Rows all_hits(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
              const HitFilter* filter) {
  Rows found;
  found.rows.resize(rays.size);
  std::vector<std::vector<IndexedHit>>& rows = found.rows;
  executor.for_each(rays.size, kBruteGrain, [&](std::size_t i) {
    for_each_hit(source, rays, i, filter, [&](const IndexedHit& hit) {
      rows[i].push_back(hit);
      return true;
    });
    std::stable_sort(rows[i].begin(), rows[i].end(),
                     [](const IndexedHit& a, const IndexedHit& b) { return a.t < b.t; });
  });
  return found;
}

}  // namespace raysheaf::brute
