// What the bundle kernels are given, whatever they look for.
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

/// Bundles [begin, end), that one thread takes.
struct TraceTask {
  std::size_t number = 0, begin = 0, end = 0;
};

struct TraceJob {
  const Executor* executor = nullptr;  ///< that runs the tasks, which ask it whether to go on
  DualScene scene;
  const Ray* rays = nullptr;
  const std::uint32_t* order = nullptr;
  std::array<std::uint32_t, kQuarters + 1> ray_starts{}, bundle_starts{};
  IndexedHit* hits = nullptr;
  std::uint8_t* occluded = nullptr;
  RowLists* rows = nullptr;             ///< one a task
  std::uint32_t* hit_counts = nullptr;  ///< of each ray: instead of rows
  float* ray_tests = nullptr;           ///< or null
  DualCounts* counts = nullptr;         ///< under `mutex`
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

/// What was found for the rays at places [first, end), in no order, as a list.
void make_rows(const Executor& executor, const std::vector<RowHit>& found, std::uint32_t first,
               std::uint32_t end, RowList* list);

void trace_closest_bundles(const TraceJob& job, const TraceTask& task);
void trace_any_bundles(const TraceJob& job, const TraceTask& task);
void trace_all_bundles(const TraceJob& job, const TraceTask& task);

}  // namespace raysheaf
