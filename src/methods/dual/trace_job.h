// The input of the bundle kernels, for every kind of query.
#pragma once

#include <mutex>

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
  const Executor* executor = nullptr;  ///< runs the tasks, which check it for cancellation
  DualScene scene;
  const Ray* rays = nullptr;
  const std::uint32_t* order = nullptr;
  bool one_start = false;  ///< as in RayOrder
  std::array<std::uint32_t, kQuarters + 1> ray_starts{}, bundle_starts{};
  IndexedHit* hits = nullptr;
  std::uint8_t* occluded = nullptr;
  RowLists* rows = nullptr;             ///< one for each task
  std::uint32_t* hit_counts = nullptr;  ///< for each ray, instead of rows
  float* ray_tests = nullptr;           ///< may be null
  DualCounts* counts = nullptr;         ///< protected by `mutex`
  std::mutex* mutex = nullptr;
  RayStreamPool* streams = nullptr;

  [[nodiscard]] BundleRange bundle(std::size_t n) const {
    std::uint32_t quarter = 0;
    while (n >= bundle_starts[quarter + 1]) ++quarter;
    const auto first = ray_starts[quarter] +
                       (static_cast<std::uint32_t>(n) - bundle_starts[quarter]) * kBundleWidth;
    return {first, std::min(kBundleWidth, ray_starts[quarter + 1] - first), quarter};
  }
};

/// Sorts the hits of the rays at places [first, end), which are in no order, into a list.
void make_rows(const Executor& executor, const std::vector<RowHit>& found, std::uint32_t first,
               std::uint32_t end, RowList* list);

void trace_closest_bundles(const TraceJob& job, const TraceTask& task);
void trace_any_bundles(const TraceJob& job, const TraceTask& task);
void trace_all_bundles(const TraceJob& job, const TraceTask& task);

}  // namespace raysheaf
