// Tests rays with every triangle of a list, on a device.
#pragma once

#include "intersect/facing_body.h"
#include "intersect/hit_filter.h"
#include "intersect/hit_word_body.h"
#include "intersect/indexed_hit.h"
#include "intersect/triangle_body.h"
#include "methods/dual/dual.h"
#include "object_tree/triangle_list.h"

namespace raysheaf {

/// Which hits of a ray count.
struct ListFilter {
  Facing facing = Facing::kBoth;
  HitFilter hits = {};
  std::uint32_t ray = 0;
};

/// Calls `take(hit)` for the hits with the triangles [first, end).
template <class Take>
RAYSHEAF_HD void meet_list(const TriangleList& list, std::uint32_t first, std::uint32_t end,
                           const ListFilter& filter, const RaySetup& setup, const Take& take) {
  for (std::uint32_t id = first; id < end; ++id) {
    const Vec3* const corner = list.corners.data + std::size_t{3} * id;
    const Vec3 a = corner[0], b = corner[1], c = corner[2];
    TriangleHit hit;
    if (!intersect_triangle(setup, a, b, c, &hit)) continue;
    if (!list.flags.empty() && !shows(filter.facing, list.flags.data[id], hit.front)) continue;
    if (!filter.hits.lets(filter.ray, id, hit.front)) continue;
    take(IndexedHit{hit.t, hit.u, hit.v, id});
  }
}

/// The best hit of these triangles, encoded as a word.
RAYSHEAF_HD inline std::uint64_t best_of_list(const TriangleList& list, std::uint32_t first,
                                              std::uint32_t end, const ListFilter& filter,
                                              const Ray& ray) {
  std::uint64_t best = kNoHitWord;
  meet_list(list, first, end, filter, make_ray_setup(ray), [&](const IndexedHit& hit) {
    const std::uint64_t word = hit_word(hit.t, hit.triangle);
    if (word < best) best = word;
  });
  return best;
}

/// Decodes a word to a hit.
RAYSHEAF_HD inline IndexedHit hit_of_word(const TriangleList& list, std::uint64_t word,
                                          const Ray& ray) {
  IndexedHit found;
  if (word == kNoHitWord) return found;
  const std::uint32_t id = triangle_of_word(word);
  meet_list(list, id, id + 1, {}, make_ray_setup(ray), [&](const IndexedHit& hit) { found = hit; });
  return found;
}

}  // namespace raysheaf
