#include "lab/commands/scale/ranks.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "apps/support/console.h"
#include "raysheaf/error.h"
#include "system/child.h"
#include "system/process.h"

namespace raysheaf::app {
namespace {

[[noreturn]] void refuse_run(const std::string& mpirun, const std::string& why) {
  throw Error(ErrorCode::kUnsupported, why, mpirun);
}

/// The sentence of this program in the output of the processes, or else their first sentence.
std::string first_sentence(const std::string& path) {
  std::ifstream file(path);
  std::string first;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("raysheaf: ")) return line.substr(std::strlen("raysheaf: "));
    if (first.empty() && line.find_first_not_of("- \t") != std::string::npos) first = line;
  }
  return first;
}

/// The exit code of a program; its output goes into `said`.
int exit_code_of(const std::vector<std::string>& words, const std::string& said) {
  system::Child child(words, system::Child::Input::kNone, said);
  if (child.failure() != 0)
    refuse_run(words.front(), std::string("cannot be started: ") + std::strerror(child.failure()));
  return child.wait(interrupted);
}

}  // namespace

RankRun measure_ranks(const std::string& mpirun, const std::string& block_file,
                      const std::string& folder, std::uint32_t side, std::uint32_t ranks,
                      std::uint32_t threads) {
  const std::string statistics = folder + "/ranks.json", said = folder + "/ranks.txt";
  std::vector<std::string> words;
  std::istringstream command(mpirun);
  for (std::string word; command >> word;) words.push_back(word);
  if (words.empty()) refuse_run("mpirun", "the command is empty");
  const std::string self = system::program_path();
  for (const std::string& word :
       {std::string("-n"), std::to_string(ranks), self, std::string("render"), block_file,
        std::string("-o"), folder + "/ranks.png", std::string("--stats"), statistics,
        std::string("--size"), fmt::format("{0}x{0}", side), std::string("--primary"),
        std::string("trace"), std::string("--share"), std::string("geometry"),
        std::string("--threads"), std::to_string(threads), std::string("-q")})
    words.push_back(word);
  RankRun best{.ranks = ranks, .threads = threads};
  for (int turn = 0; turn < 2; ++turn) {
    const int code = exit_code_of(words, said);
    stop_if_interrupted();
    if (code != 0) {
      const std::string why = first_sentence(said);
      refuse_run(mpirun, why.empty() ? fmt::format("ended with status {}", code) : why);
    }
    std::ifstream file(statistics);
    const auto run = nlohmann::json::parse(file);
    const auto& times = run["times_ms"];
    const double seconds = 1e-3 * (times["total"].get<double>() - times["load"].get<double>());
    if (turn > 0 && seconds >= best.seconds) continue;
    best.seconds = seconds;
    best.bytes = run["stream"]["read_bytes"];
  }
  return best;
}

}  // namespace raysheaf::app
