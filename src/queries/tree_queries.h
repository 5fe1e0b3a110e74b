// The queries of one thread on a tree that others ask at the same time: small batches, whose rays
// stay in the thread's caches.
#pragma once

#include "queries/planned_queries.h"

namespace raysheaf {

/// Not for use by two threads at once; each has its own. Of an engine between its `prepare_tree`
/// and its next change or query. Hits are the engine's own, bit for bit; there is no fan.
class TreeQueries {
 public:
  /// `explain`: write the plan. Adds to the report.
  void closest_hit(const PlannedQueries& engine, View<const Ray> rays,
                   const PlannedOptions& options, bool explain, View<IndexedHit> hits,
                   View<float> ray_tests, QueryReport* report);
  void any_hit(const PlannedQueries& engine, View<const Ray> rays, const PlannedOptions& options,
               bool explain, View<std::uint8_t> occluded, View<float> ray_tests,
               QueryReport* report);

 private:
  /// Orders the rays; returns what they go through.
  DualScene prepare(const PlannedQueries& engine, View<const Ray> rays,
                    const PlannedOptions& options, bool explain, QueryReport* report);

  const Executor executor_ = Executor::serial();
  RayOrder order_;
  RayStreamPool streams_;
};

}  // namespace raysheaf
