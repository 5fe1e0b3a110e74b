// What the packet kernels are given, whatever they look for.
#pragma once

#include <mutex>

#include "exec/executor.h"
#include "methods/dual/packet.h"
#include "methods/dual/stream.h"

namespace raysheaf {

/// A run of at most kPacketWidth rays of one quarter.
struct PacketRange {
  std::uint32_t first = 0, count = 0, quarter = 0;
};

/// Packets [begin, end), that one thread takes.
struct TraceTask {
  std::size_t number = 0, begin = 0, end = 0;
};

struct TraceJob {
  const Executor* executor = nullptr;  ///< that runs the tasks, which ask it whether to go on
  DualScene scene;
  const Ray* rays = nullptr;
  const std::uint32_t* order = nullptr;
  std::array<std::uint32_t, kQuarters + 1> ray_starts{}, packet_starts{};
  EngineHit* hits = nullptr;
  std::uint8_t* occluded = nullptr;
  RowLists* rows = nullptr;             ///< one a task
  std::uint32_t* hit_counts = nullptr;  ///< of each ray: instead of rows
  float* ray_tests = nullptr;           ///< or null
  DualCounts* counts = nullptr;         ///< under `mutex`
  std::mutex* mutex = nullptr;
  StreamPool* streams = nullptr;

  [[nodiscard]] PacketRange packet(std::size_t n) const {
    std::uint32_t quarter = 0;
    while (n >= packet_starts[quarter + 1]) ++quarter;
    const auto first = ray_starts[quarter] +
                       (static_cast<std::uint32_t>(n) - packet_starts[quarter]) * kPacketWidth;
    return {first, std::min(kPacketWidth, ray_starts[quarter + 1] - first), quarter};
  }
};

/// What was found for the rays at places [first, end), in no order, as a list.
void make_rows(const Executor& executor, const std::vector<RowHit>& found, std::uint32_t first,
               std::uint32_t end, RowList* list);

void trace_closest_packets(const TraceJob& job, const TraceTask& task);
void trace_any_packets(const TraceJob& job, const TraceTask& task);
void trace_all_packets(const TraceJob& job, const TraceTask& task);

}  // namespace raysheaf
