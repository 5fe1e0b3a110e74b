// Real runs of several processes, to hold the model against.
#pragma once

#include <cstdint>
#include <string>

namespace raysheaf::app {

/// A frame of a block file that `ranks` processes made together, sharing its blocks.
struct RankRun {
  std::uint32_t ranks = 1, threads = 1;  ///< threads: of a process
  double seconds = 0;                    ///< of the clock, from the open file to the picture
  double bytes = 0;                      ///< read by all of them
};

/// Runs `raysheaf render` in `ranks` processes twice and gives the faster run. `mpirun` is a
/// command and its options, words between spaces; its files go into `folder`. Throws `Error`
/// (kUnsupported) with the first sentence of what could not be started or failed.
[[nodiscard]] RankRun measure_ranks(const std::string& mpirun, const std::string& block_file,
                                    const std::string& folder, std::uint32_t side,
                                    std::uint32_t ranks, std::uint32_t threads);

}  // namespace raysheaf::app
