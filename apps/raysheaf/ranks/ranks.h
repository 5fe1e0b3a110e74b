// The processes that mpirun started, if `render` runs in several.
//
// Only rank 0 prints, and its exit code is that of the run. mpirun ends all processes at the first
// one that fails, so the others end without an error.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "options.h"
#include "raysheaf/distributed.h"

namespace raysheaf::app {

/// The size and rank that the launcher reports; 1 and 0 without a launcher.
struct Launch {
  std::uint32_t rank = 0, size = 1;
};
[[nodiscard]] Launch launch();

/// The processes of the launch. Throws `Error` (kUnsupported) in a build without MPI.
[[nodiscard]] std::shared_ptr<Communicator> open_ranks();

/// Runs `work` in every process; its argument is null for a single process, and for one that works
/// independently. An exception of `work` in any process is thrown in all of them, with its rank in
/// the place.
void run_together(const RenderCommand& command,
                  const std::function<void(const std::shared_ptr<Communicator>&)>& work);

/// The device that traces the command's rays.
[[nodiscard]] Context context_of(const RenderCommand& command,
                                 const std::shared_ptr<Communicator>& ranks);

/// The sentences of all processes, by rank. Collective.
[[nodiscard]] std::vector<std::string> sentences_of_all(Communicator& ranks,
                                                        const std::vector<std::string>& own);

/// How many processes shared a frame, and by which part of the work.
struct SharedBy {
  std::uint32_t count = 1;
  std::string what;
};
/// Adds that to the JSON of a frame's statistics.
[[nodiscard]] std::string with_ranks(std::string json, const SharedBy& ranks);

/// Whether this process writes the files.
[[nodiscard]] inline bool is_first(const Communicator* ranks) {
  return ranks == nullptr || ranks->rank() == 0;
}

}  // namespace raysheaf::app
