// Compiled once for each SIMD target and chosen at run time (Google Highway). No operation is
// fused, so that every target makes the same tests and gives the same hits.
#include <atomic>
#include <cstring>
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

#include "base/lanes-inl.h"
#include "intersect/edges-inl.h"
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

DualCounts TraceStreams(const TraceJob& job, const TraceTask& task) {
  if (job.results.hits.data != nullptr) return StreamWalk<ClosestMode>(job).run(task);
  if (job.results.occluded.data != nullptr) return StreamWalk<AnyMode>(job).run(task);
  return StreamWalk<AllMode>(job).run(task);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(TraceStreams);

DualCounts trace_streams(const TraceJob& job, const TraceTask& task) {
  return HWY_DYNAMIC_DISPATCH(TraceStreams)(job, task);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
