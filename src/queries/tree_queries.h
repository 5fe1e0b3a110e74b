// The queries of one thread on a tree that other threads query at the same time: small batches,
// whose rays stay in the thread's caches.
#pragma once

#include "queries/planned_queries.h"

namespace raysheaf {

/// Not for two threads at once; each thread has its own. Valid between an engine's `prepare_tree`
/// and its next change or query. Hits are those of the engine, bit for bit.
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
  /// Orders the rays; returns the scene and the bundles for tracing.
  DualScene prepare(const PlannedQueries& engine, View<const Ray> rays,
                    const PlannedOptions& options, bool explain, QueryReport* report);

  const Executor executor_ = Executor::serial();
  RayOrder order_;
  RayStreamPool streams_;
};

}  // namespace raysheaf
