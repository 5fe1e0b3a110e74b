// A batch as its tasks see it.
#pragma once

#include "exec/executor.h"
#include "methods/dual/bundle16.h"
#include "methods/dual/ray_stream.h"

namespace raysheaf {

/// A run of at most kBundleWidth rays of one quarter.
struct BundleRange {
  std::uint32_t first = 0, count = 0, quarter = 0;
};

/// Bundles [begin, end) of one task.
struct TraceTask {
  std::size_t number = 0, begin = 0, end = 0;
};

struct TraceJob {
  const Executor& executor;  ///< which tasks check for cancellation
  const DualScene scene;
  const Ray* const rays;
  const RayOrder& order;
  const DualResults results;  ///< with a list of `rows` for each task
  RayStreamPool* const streams;
  std::array<std::uint32_t, kQuarters + 1> bundle_starts{};

  [[nodiscard]] BundleRange bundle(std::size_t n) const {
    std::uint32_t quarter = 0;
    while (n >= bundle_starts[quarter + 1]) ++quarter;
    const auto first = order.starts[quarter] +
                       (static_cast<std::uint32_t>(n) - bundle_starts[quarter]) * kBundleWidth;
    return {first, std::min(kBundleWidth, order.starts[quarter + 1] - first), quarter};
  }
};

/// Sorts the hits of the rays at places [first, end), which are in no order, into a list.
void make_rows(const Executor& executor, const std::vector<RowHit>& found, std::uint32_t first,
               std::uint32_t end, RowList* list);

/// The work of one thread; returns its tests.
DualCounts trace_streams(const TraceJob& job, const TraceTask& task);

}  // namespace raysheaf
