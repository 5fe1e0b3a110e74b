#include "render/frame/shared_trace.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace raysheaf {
namespace {

RayBatch piece_of(const RayBatch& batch, std::size_t begin, std::size_t end) {
  RayBatch piece = part_of_batch(batch, [begin, end]<class T>(const LargeVector<T>& column) {
    if (column.empty()) return column;
    return LargeVector<T>(column.begin() + static_cast<std::ptrdiff_t>(begin),
                          column.begin() + static_cast<std::ptrdiff_t>(end));
  });
  for (const std::size_t light_end : batch.light_ends)
    piece.light_ends.push_back(
        static_cast<std::uint32_t>(std::clamp(light_end, begin, end) - begin));
  return piece;
}

/// Adds the counts of all processes, and the other statistics of this one.
void add_up(Communicator& ranks, BatchStatistics own, BatchStatistics* statistics) {
  std::vector<std::uint64_t> numbers = numbers_of(own);
  add(ranks, numbers);
  const std::vector<std::uint64_t> before = numbers_of(*statistics);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += before[i];
  set_numbers(numbers.data(), statistics);
  statistics->times_ms.add(own.times_ms);
  std::move(own.plan.begin(), own.plan.end(), std::back_inserter(statistics->plan));
  std::move(own.bundles.begin(), own.bundles.end(), std::back_inserter(statistics->bundles));
}

}  // namespace

Communicator* sharers(Communicator* ranks, const RayBatch& batch) {
  const bool worth = ranks != nullptr && ranks->size() > 1 &&
                     pieces_of(batch.rays.size(), ranks->size()).number() > 1;
  return worth ? ranks : nullptr;
}

std::vector<RayHit> trace_shared(Communicator& ranks, const RayBatch& batch,
                                 BatchStatistics* statistics, View<float> ray_tests,
                                 ProgressMeter* meter, const TracePiece& trace) {
  const Pieces pieces = pieces_of(batch.rays.size(), ranks.size());
  meter->begin(stage_name(batch.kind, batch.bounce) + ", of all ranks", batch.rays.size());
  // Hits of other processes' rays stay zero, so that a bitwise or combines them.
  std::vector<RayHit> hits(batch.rays.size(), RayHit{0, 0});
  std::vector<float> tests(ray_tests.size);
  BatchStatistics own;
  std::size_t made = 0, done = 0, first_plan = 0;
  share_out(ranks, pieces, [&](std::size_t begin, std::size_t end) {
    ProgressMeter quiet;
    const View<float> piece_tests =
        View<float>(tests).slice(tests.empty() ? 0 : begin, tests.empty() ? 0 : end - begin);
    const std::vector<RayHit> found = trace(piece_of(batch, begin, end), &own, piece_tests, &quiet);
    std::copy(found.begin(), found.end(), hits.begin() + static_cast<std::ptrdiff_t>(begin));
    // Pieces are taken in order: those before this one are done or taken by others.
    meter->advance(end - std::exchange(done, end));
    // The plan of a batch is that of its first piece in this process.
    if (++made == 1) first_plan = own.plan.size();
    own.plan.resize(first_plan);
  });
  unite(ranks, std::span(hits));
  if (!tests.empty()) unite(ranks, std::span(tests));
  for (std::size_t i = 0; i < tests.size(); ++i) ray_tests[i] += tests[i];
  own.plan.push_back(std::to_string(made) + " of " + std::to_string(pieces.number()) +
                     " pieces of the batch were traced here, on rank " +
                     std::to_string(ranks.rank()) + " of " + std::to_string(ranks.size()));
  add_up(ranks, std::move(own), statistics);
  return hits;
}

}  // namespace raysheaf
