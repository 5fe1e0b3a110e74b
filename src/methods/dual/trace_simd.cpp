// Compiled once for each SIMD target and chosen at run time (Google Highway). No operation is
// fused, so that every target makes the same tests and gives the same hits.
#include <atomic>
#include <cstring>
#include <mutex>
#include <utility>

#include <hwy/cache_control.h>

#include "base/float.h"
#include "geom/ray_end.h"
#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"
#include "methods/dual/ray_stream.h"
#include "methods/dual/trace_job.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/dual/trace_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "intersect/values-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The order matters: each depends on those before it.
#include "methods/dual/bundle16-inl.h"

#include "methods/dual/triangle-inl.h"

#include "methods/dual/single-inl.h"

#include "methods/dual/from_origin-inl.h"

#include "methods/dual/stream_walk-inl.h"

/// Consecutive bundles of one quarter form a stream.
template <class Mode>
void walk_streams(const TraceJob& job, const TraceTask& task) {
  const std::uint32_t most =
      job.scene.bundle == Bundle::kLongStream ? kLongStreamRays : kStreamRays;
  StreamWalk<Mode> walk(job);
  for (std::size_t n = task.begin; n < task.end;) {
    const BundleRange first = job.bundle(n);
    std::uint32_t count = first.count;
    for (++n; n < task.end && count + kBundleWidth <= most; ++n) {
      const BundleRange next = job.bundle(n);
      if (next.quarter != first.quarter) break;
      count += next.count;
    }
    walk.run(first.first, count, first.quarter);
  }
  walk.finish(task);
}

void TraceClosest(const TraceJob& job, const TraceTask& task) {
  walk_streams<ClosestMode>(job, task);
}
void TraceAny(const TraceJob& job, const TraceTask& task) {
  walk_streams<AnyMode>(job, task);
}
void TraceAll(const TraceJob& job, const TraceTask& task) {
  walk_streams<AllMode>(job, task);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(TraceClosest);
HWY_EXPORT(TraceAny);
HWY_EXPORT(TraceAll);

void trace_closest_bundles(const TraceJob& job, const TraceTask& task) {
  HWY_DYNAMIC_DISPATCH(TraceClosest)(job, task);
}
void trace_any_bundles(const TraceJob& job, const TraceTask& task) {
  HWY_DYNAMIC_DISPATCH(TraceAny)(job, task);
}
void trace_all_bundles(const TraceJob& job, const TraceTask& task) {
  HWY_DYNAMIC_DISPATCH(TraceAll)(job, task);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
