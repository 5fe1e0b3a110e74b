// Compiled once a SIMD target and chosen at run time (Google Highway). No operation is fused, so
// that every target makes the same tests and gives the same hits.
#include <atomic>
#include <mutex>

#include "base/float.h"
#include "dual/trace_job.h"
#include "geom/ray_end.h"
#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dual/trace_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "dual/packet-inl.h"
#include "dual/triangle-inl.h"
#include "dual/walk-inl.h"

template <class Mode>
void trace_packets(const TraceJob& job, std::size_t begin, std::size_t end) {
  Walk<Mode> walk(job);
  for (std::size_t n = begin; n < end; ++n) walk.run(job.packet(n));
  walk.finish();
}

void TraceClosest(const TraceJob& job, std::size_t begin, std::size_t end) {
  trace_packets<ClosestMode>(job, begin, end);
}
void TraceAny(const TraceJob& job, std::size_t begin, std::size_t end) {
  trace_packets<AnyMode>(job, begin, end);
}
void TraceAll(const TraceJob& job, std::size_t begin, std::size_t end) {
  trace_packets<AllMode>(job, begin, end);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(TraceClosest);
HWY_EXPORT(TraceAny);
HWY_EXPORT(TraceAll);

void trace_closest_packets(const TraceJob& job, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(TraceClosest)(job, begin, end);
}
void trace_any_packets(const TraceJob& job, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(TraceAny)(job, begin, end);
}
void trace_all_packets(const TraceJob& job, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(TraceAll)(job, begin, end);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
