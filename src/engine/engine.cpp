#include "engine/engine.h"

#include <algorithm>

#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// Calls `take(hit)` for every hit of a ray.
template <class Take>
void for_each_hit(const TriangleSource& source, const Ray& ray, const EngineOptions& options,
                  const Take& take) {
  const RaySetup setup = make_ray_setup(ray);
  source.for_each_part(
      0, source.count, [&](const TriangleRun& run, std::uint32_t b, std::uint32_t e) {
        for (std::uint32_t i = b; i < e; ++i) {
          const auto [p, q, r] = run.corners(i);
          TriangleHit hit;
          if (has_no_area(p, q, r) || !intersect_triangle(setup, p, q, r, &hit)) continue;
          const std::uint32_t id = run.first + i;
          if (source.flags != nullptr && !shows(options.facing, source.flags[id], hit.front))
            continue;
          take(EngineHit{hit.t, hit.u, hit.v, id});
        }
      });
}

bool precedes(const EngineHit& a, const EngineHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}

}  // namespace

void Engine::set_triangles(const TriangleSource& source, bool same_triangles) {
  source_ = source;
  state_ = same_triangles && state_ != State::kStale ? State::kMoved : State::kStale;
}

void Engine::closest_hit(const Executor& executor, View<const Ray> rays,
                         const EngineOptions& options, View<EngineHit> hits, View<float>,
                         EngineReport*) {
  executor.for_each(rays.size, 64, [&](std::size_t i) {
    EngineHit best;
    for_each_hit(source_, rays[i], options, [&](const EngineHit& hit) {
      if (precedes(hit, best)) best = hit;
    });
    hits[i] = best;
  });
}

void Engine::any_hit(const Executor& executor, View<const Ray> rays, const EngineOptions& options,
                     View<std::uint8_t> occluded, View<float>, EngineReport*) {
  executor.for_each(rays.size, 64, [&](std::size_t i) {
    occluded[i] = 0;
    for_each_hit(source_, rays[i], options, [&](const EngineHit&) { occluded[i] = 1; });
  });
}

EngineHitRows Engine::all_hits(const Executor& executor, View<const Ray> rays,
                               const EngineOptions& options, EngineReport*) {
  std::vector<std::vector<EngineHit>> rows(rays.size);
  executor.for_each(rays.size, 64, [&](std::size_t i) {
    for_each_hit(source_, rays[i], options, [&](const EngineHit& h) { rows[i].push_back(h); });
    std::sort(rows[i].begin(), rows[i].end(), precedes);
  });
  EngineHitRows out;
  out.offsets.assign(1, 0);
  for (const std::vector<EngineHit>& row : rows) {
    out.hits.insert(out.hits.end(), row.begin(), row.end());
    out.offsets.push_back(out.hits.size());
  }
  return out;
}

std::size_t Engine::memory_bytes() const {
  return tree_.nodes.capacity_bytes() + tree_.quads.capacity_bytes();
}

}  // namespace raysheaf
