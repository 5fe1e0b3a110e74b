#include "ranks/ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <new>
#include <span>
#include <string>

#include "apps/support/values.h"
#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

/// The number in an environment variable, if it holds one.
std::optional<std::uint32_t> number_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr) return std::nullopt;
  try {
    return parse_count(text, 0, 0x7fffffff);
  } catch (const Error&) {
    return std::nullopt;
  }
}

void take_bits(const std::byte* from, std::byte* into, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) into[i] |= from[i];
}

/// Combines the bytes of all processes; the others have zeros.
template <class T>
void unite(Communicator& ranks, std::vector<T>* numbers) {
  ranks.combine(std::as_writable_bytes(std::span(*numbers)), 1, take_bits);
}

/// The sentence of a caught exception.
Error caught() {
  try {
    throw;
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return {ErrorCode::kOutOfMemory, "out of memory"};
  } catch (const std::exception& error) {
    return {ErrorCode::kInternal, std::string("an internal error: ") + error.what()};
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
    ranks->combine({}, 1, nullptr);  // no process ends before all have finished
  } catch (...) {
    throw ranks->fail(caught());
  }
}

Context context_of(const RenderCommand& command, const std::shared_ptr<Communicator>& ranks) {
  const ContextOptions options{command.device, command.options.threads};
  return ranks == nullptr ? Context(options) : distributed(options, ranks);
}

std::vector<std::string> sentences_of_all(Communicator& ranks,
                                          const std::vector<std::string>& own) {
  std::string text;
  for (const std::string& sentence : own) text += sentence + '\0';
  std::vector<std::uint64_t> sizes(ranks.size());
  sizes[ranks.rank()] = text.size();
  unite(ranks, &sizes);
  std::size_t before = 0, whole = 0;
  for (std::uint32_t i = 0; i < ranks.size(); ++i) {
    if (i < ranks.rank()) before += sizes[i];
    whole += sizes[i];
  }
  std::vector<char> texts(whole);
  std::copy(text.begin(), text.end(), texts.begin() + static_cast<std::ptrdiff_t>(before));
  unite(ranks, &texts);
  std::vector<std::string> all;
  for (std::size_t at = 0; at < whole; at += all.back().size() + 1)
    all.emplace_back(texts.data() + at);
  return all;
}

std::string with_ranks(std::string json, const SharedBy& ranks) {
  return json.insert(json.rfind("\n}"), fmt::format(",\n  \"ranks\": {},\n  \"shared\": \"{}\"",
                                                    ranks.count, ranks.what));
}

}  // namespace raysheaf::app
