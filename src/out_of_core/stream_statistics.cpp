// Sums of the blocks that were read or culled.
#include <vector>

#include "out_of_core/streamer.h"

namespace raysheaf {
namespace {

constexpr std::uint64_t StreamStatistics::*kStreamCounts[] = {
    &StreamStatistics::blocks,        &StreamStatistics::culled_blocks,
    &StreamStatistics::hidden_blocks, &StreamStatistics::read_blocks,
    &StreamStatistics::wasted_blocks, &StreamStatistics::shading_blocks,
    &StreamStatistics::read_bytes};
constexpr double StreamStatistics::*kStreamTimes[] = {
    &StreamStatistics::read_ms, &StreamStatistics::wait_ms, &StreamStatistics::cull_ms,
    &StreamStatistics::trace_ms, &StreamStatistics::shading_ms};

}  // namespace

void add(const StreamStatistics& more, StreamStatistics* sum) {
  for (const auto field : kStreamCounts) sum->*field += more.*field;
  for (const auto field : kStreamTimes) sum->*field += more.*field;
}

StreamStatistics of_all(StreamStatistics own, HitExchange* exchange) {
  if (exchange == nullptr) return own;
  std::vector<std::uint64_t> counts;
  std::vector<double> times;
  for (const auto field : kStreamCounts) counts.push_back(own.*field);
  for (const auto field : kStreamTimes) times.push_back(own.*field);
  exchange->add(counts);
  exchange->add(times);
  for (std::size_t i = 0; i < counts.size(); ++i) own.*kStreamCounts[i] = counts[i];
  for (std::size_t i = 0; i < times.size(); ++i) own.*kStreamTimes[i] = times[i];
  return own;
}

}  // namespace raysheaf
