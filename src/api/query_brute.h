// Brute force: tests every ray with every triangle of a view, as the reference for all methods.
#pragma once

#include "queries/planned_queries.h"

namespace raysheaf::brute {

/// As the queries of `PlannedQueries`. `filter` of hits: null takes all.
void closest_hit(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
                 const HitFilter* filter, View<IndexedHit> hits);
void any_hit(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
             const HitFilter* filter, View<std::uint8_t> occluded);
/// All hits by ray, each row by (t, triangle).
struct Rows {
  std::vector<std::vector<IndexedHit>> rows;

  /// As `FoundRows::for_each`.
  template <class Body>
  void for_each(const Executor& executor, const Body& body) const {
    executor.for_each(rows.size(), 1024,
                      [&](std::size_t ray) { body(ray, View<const IndexedHit>(rows[ray])); });
  }
};
[[nodiscard]] Rows all_hits(const Executor& executor, const TriangleSource& source,
                            View<const Ray> rays, const HitFilter* filter);

}  // namespace raysheaf::brute
