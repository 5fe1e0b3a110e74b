#include "ranks/ranks.h"

#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "raysheaf/error.h"
#include "values.h"

namespace raysheaf::app {
namespace {

/// The number in an environment variable; none where there is no number.
std::optional<std::uint32_t> number_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr) return std::nullopt;
  try {
    return parse_count(text, 0, 0x7fffffff);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Of whatever is caught.
Error caught() {
  try {
    throw;
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return {ErrorCode::kOutOfMemory, "out of memory"};
  } catch (const std::exception& error) {
    return {ErrorCode::kInternal, std::string("an error that should not happen: ") + error.what()};
  }
}

}  // namespace

Launch launch() {
  // Open MPI's mpirun; Hydra, of MPICH and Intel MPI.
  const char* const launchers[][2] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                      {"PMI_RANK", "PMI_SIZE"}};
  for (const auto& [rank, size] : launchers) {
    const std::optional<std::uint32_t> r = number_in(rank), s = number_in(size);
    if (r && s && *r < *s) return {*r, *s};
  }
  return {};
}

void run_together(const RenderCommand& command,
                  const std::function<void(const std::shared_ptr<Communicator>&)>& work) {
  if (launch().size == 1 || command.share == Share::kNone) return work(nullptr);
  const std::shared_ptr<Communicator> ranks = open_ranks();
  try {
    work(ranks);
    ranks->combine({}, 1, nullptr);  // nobody is done before all are
  } catch (...) {
    throw ranks->fail(caught());
  }
}

Context context_of(const RenderCommand& command, const std::shared_ptr<Communicator>& ranks) {
  const ContextOptions options{command.device, command.options.threads};
  return ranks == nullptr ? Context(options) : distributed(options, ranks);
}

std::string with_ranks(std::string json, const SharedBy& ranks) {
  return json.insert(json.rfind("\n}"), fmt::format(",\n  \"ranks\": {},\n  \"shared\": \"{}\"",
                                                    ranks.count, ranks.what));
}

}  // namespace raysheaf::app
