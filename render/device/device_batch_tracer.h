// Methods that order the rays of a batch before they trace them (`rah`, `crsh`, `gl10`), on a
// device.
#pragma once

#include "intersect/indexed_hit.h"
#include "intersect/intersect_list.h"
#include "object_tree/triangle_list.h"
#include "queries/query_report.h"
#include "raysheaf/method.h"
#include "raysheaf/statistics.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// How a method traces a batch.
struct BatchOptions {
  MethodSettings method;
  Facing facing = Facing::kBoth;
  std::uint32_t bundle_samples = 0;  ///< number of bundles to measure per level, on the CPU
  bool early_out = false;            ///< for rays of which only occlusion matters
};

/// Whether the method orders rays by keys; `dual` does not need them.
[[nodiscard]] inline bool orders_rays(Traversal traversal) {
  return traversal == Traversal::kRayHierarchy || traversal == Traversal::kPackets;
}

/// Traces the batches of one scene on one device, by one method. Not for two threads at once.
class DeviceBatchTracer {
 public:
  virtual ~DeviceBatchTracer() = default;
  /// `triangles`: those of `scene`, used in place if they are in the device's memory.
  virtual void set_scene(const Executor& executor, const FlatScene& scene,
                         const TriangleList& triangles) = 0;
  /// hits[i] receives the hit of rays[i] with the least (t, triangle). `keys`: the sort keys of the
  /// rays, of `key_bits` bits; empty: the rays stay in their order. Each array may be in the host's
  /// or the device's memory; the work that writes it must be complete. Adds the counts of the CPU
  /// to `statistics`, and times to `report` unless that is null.
  virtual void trace(View<const Ray> rays, View<const std::uint32_t> keys, std::uint32_t key_bits,
                     const BatchOptions& options, View<IndexedHit> hits,
                     BatchStatistics* statistics, QueryReport* report) = 0;
};

}  // namespace raysheaf
