#include "lab/commands/scale/ranks.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "apps/support/console.h"
#include "raysheaf/error.h"

extern char** environ;

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
int exit_code_of(std::vector<std::string> words, const std::string& said) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, said.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, argv.front(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0)
    refuse_run(words.front(), std::string("cannot be started: ") + std::strerror(failed));
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR)
    if (interrupted()) kill(process, SIGTERM);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
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
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
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
