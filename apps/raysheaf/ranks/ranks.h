// The processes that mpirun started, where `render` runs in several.
//
// Rank 0 speaks, and its exit code is the run's: mpirun ends all at the first process that fails,
// so the others end quietly.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "options.h"
#include "raysheaf/distributed.h"

namespace raysheaf::app {

/// What the launcher says of this process; alone where there is none.
struct Launch {
  std::uint32_t rank = 0, size = 1;
};
[[nodiscard]] Launch launch();

/// The processes of the launch. Throws `Error` (kUnsupported) in a build without MPI.
[[nodiscard]] std::shared_ptr<Communicator> open_ranks();

/// Runs `work` in every process: null for one that is alone, or stays by itself. What `work`
/// throws in any process, this throws in all of them, with the rank in its place.
void run_together(const RenderCommand& command,
                  const std::function<void(const std::shared_ptr<Communicator>&)>& work);

/// Where the command's rays are traced.
[[nodiscard]] Context context_of(const RenderCommand& command,
                                 const std::shared_ptr<Communicator>& ranks);

/// Sentences of all processes, by rank. Collective.
[[nodiscard]] std::vector<std::string> sentences_of_all(Communicator& ranks,
                                                        const std::vector<std::string>& own);

/// How many processes shared a frame, and what.
struct SharedBy {
  std::uint32_t count = 1;
  std::string what;
};
/// Puts that into the JSON of a frame's statistics.
[[nodiscard]] std::string with_ranks(std::string json, const SharedBy& ranks);

/// Whether this process is the one that writes.
[[nodiscard]] inline bool is_first(const Communicator* ranks) {
  return ranks == nullptr || ranks->rank() == 0;
}

}  // namespace raysheaf::app
