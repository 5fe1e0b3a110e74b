// Real runs of several processes, to compare the model with.
#pragma once

#include <cstdint>
#include <string>

namespace raysheaf::app {

/// A frame of a block file that `ranks` processes made together, by sharing its blocks.
struct RankRun {
  std::uint32_t ranks = 1, threads = 1;  ///< threads: of each process
  double seconds = 0;                    ///< wall time, from the open file to the image
  double bytes = 0;                      ///< read by all of them
};

/// Runs `raysheaf render` in `ranks` processes twice and returns the faster run. `mpirun` is a
/// command with its options, separated by spaces; its files go into `folder`. Throws `Error`
/// (kUnsupported) with the first sentence of the failure.
[[nodiscard]] RankRun measure_ranks(const std::string& mpirun, const std::string& block_file,
                                    const std::string& folder, std::uint32_t side,
                                    std::uint32_t ranks, std::uint32_t threads);

}  // namespace raysheaf::app
