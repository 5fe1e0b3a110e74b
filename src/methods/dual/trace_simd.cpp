// Compiled once for each SIMD target and chosen at run time (Google Highway). No operation is
// fused, so that every target makes the same tests and gives the same hits.
#include <algorithm>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

#include <hwy/cache_control.h>

#include "base/bits.h"
#include "base/float.h"
#include "geom/ray_end.h"
#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"
#include "methods/dual/ray_stream.h"

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

#include "methods/dual/few-inl.h"

/// The rays of a batch that has no more.
DualCounts TraceFew(const TraceJob& job, std::uint32_t count) {
  if (job.results.hits.data != nullptr) return FewWalk<ClosestMode>(job).run(count);
  return FewWalk<AnyMode>(job).run(count);
}

/// The work of one thread; returns its tests.
DualCounts TraceStreams(const StreamJob& job, const TraceTask& task) {
  if (job.results.hits.data != nullptr) return StreamWalk<ClosestMode>(job).run(task);
  if (job.results.occluded.data != nullptr) return StreamWalk<AnyMode>(job).run(task);
  return StreamWalk<AllMode>(job).run(task);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

namespace {

HWY_EXPORT(TraceFew);
HWY_EXPORT(TraceStreams);

/// Bundles per task: two streams.
constexpr std::size_t kBundlesATask = 2 * kStreamRays / kBundleWidth;
/// A long stream takes at most this fraction of the remaining bundles, so that threads finish
/// together.
constexpr std::size_t kPartOfRest = 4;

/// Divides every quarter into the fewest long streams of equal length, one task each; streams
/// become shorter towards the end (C. Polychronopoulos, D. Kuck, "Guided Self-Scheduling", 1987).
void cut_into_long_streams(const StreamJob& job, std::vector<std::size_t>* starts) {
  constexpr std::size_t kLeast = kStreamRays / kBundleWidth, kMost = kLongStreamRays / kBundleWidth;
  for (std::uint32_t q = 0; q < kQuarters; ++q) {
    const std::size_t first = job.bundle_starts[q], count = job.bundle_starts[q + 1] - first;
    const std::size_t rest = job.bundle_starts[kQuarters] - first;
    const std::size_t parts = div_ceil(count, std::clamp(rest / kPartOfRest, kLeast, kMost));
    for (std::size_t i = 0; i < parts; ++i) starts->push_back(first + i * count / parts);
  }
}

/// The results in a scene without triangles.
void find_nothing(const DualResults& results) {
  std::fill(results.hits.begin(), results.hits.end(), IndexedHit{});
  std::fill(results.occluded.begin(), results.occluded.end(), std::uint8_t{0});
  if (results.rows != nullptr) results.rows->clear();
}

}  // namespace

std::vector<std::size_t> cut_into_tasks(StreamJob* job) {
  const auto& starts_of_rays = job->order.starts;
  for (std::uint32_t q = 0; q < kQuarters; ++q)
    job->bundle_starts[q + 1] =
        job->bundle_starts[q] + div_ceil(starts_of_rays[q + 1] - starts_of_rays[q], kBundleWidth);
  const std::size_t bundles = job->bundle_starts[kQuarters];
  std::vector<std::size_t> starts;
  if (job->scene.bundle == Bundle::kLongStream) {
    cut_into_long_streams(*job, &starts);
  } else {
    for (std::size_t n = 0; n < bundles; n += kBundlesATask) starts.push_back(n);
  }
  starts.push_back(bundles);
  return starts;
}

void RayStream::fit(std::uint32_t size) {
  if (size <= rays.size()) return;
  const std::size_t room = div_ceil(size, kBundleWidth) * kBundleWidth;
  rays.resize_uninitialized(room);
  index.resize_uninitialized(room);
  lists.resize_uninitialized(16 * room);
}

void RayStream::grow_lists(std::size_t size) {
  if (size <= lists.size()) return;
  Buffer<std::uint32_t> larger;
  larger.resize_uninitialized(std::max(size, 2 * lists.size()));
  std::memcpy(larger.data(), lists.data(), lists.size() * sizeof(std::uint32_t));
  lists = std::move(larger);
}

void make_rows(const Executor& executor, const std::vector<RowHit>& found, std::uint32_t first,
               std::uint32_t end, RowList* list) {
  list->first = first;
  list->ends.resize_uninitialized(end - first);
  list->hits.resize_uninitialized(found.size());
  std::fill(list->ends.begin(), list->ends.end(), std::uint64_t{0});
  // ends[i] is first the length of row i, then its begin, and finally, after filling, its end.
  for (const RowHit& hit : found) ++list->ends[hit.place - first];
  std::uint64_t begin = 0;
  for (std::uint64_t& at : list->ends) begin += std::exchange(at, begin);
  for (const RowHit& hit : found) list->hits[list->ends[hit.place - first]++] = hit.hit;
  begin = 0;
  for (const std::uint64_t row_end : list->ends) {
    executor.check();
    std::sort(list->hits.begin() + begin, list->hits.begin() + row_end,
              [](const IndexedHit& a, const IndexedHit& b) {
                return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
              });
    begin = row_end;
  }
}

void trace_rays(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                const RayOrder& order, const DualResults& results, DualCounts* counts) {
  std::fill(results.hit_counts.begin(), results.hit_counts.end(), 0u);
  if (scene.tree->empty()) return find_nothing(results);
  RayStreamPool own;
  RayStreamPool* const streams = scene.streams != nullptr ? scene.streams : &own;
  StreamJob job{{executor, scene, rays.data, results}, order, streams};
  const std::vector<std::size_t> starts = cut_into_tasks(&job);
  const std::size_t tasks = starts.size() - 1;
  if (results.rows != nullptr) results.rows->resize(tasks);
  std::mutex mutex;
  executor.for_each(tasks, 1, [&](std::size_t n) {
    const DualCounts found = HWY_DYNAMIC_DISPATCH(TraceStreams)(job, {n, starts[n], starts[n + 1]});
    const std::lock_guard<std::mutex> lock(mutex);
    if (counts != nullptr) counts->add(found);
  });
}

void trace_few_rays(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                    const DualResults& results, DualCounts* counts) {
  if (scene.tree->empty()) return find_nothing(results);
  const DualCounts found = HWY_DYNAMIC_DISPATCH(TraceFew)({executor, scene, rays.data, results},
                                                          static_cast<std::uint32_t>(rays.size));
  if (counts != nullptr) counts->add(found);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
