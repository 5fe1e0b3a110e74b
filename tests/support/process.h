// Runs programs as a user would.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "support/folder.h"

namespace raysheaf::test {

/// How a program ended: `code` is its exit code, or 128 plus the signal that killed it.
struct Finished {
  int code = 0;
  std::string out, err;
  std::size_t memory_bytes = 0;  ///< its peak memory use
};

/// Starts `arguments[0]` in `folder` and waits. If `interrupt_after` is positive, sends SIGINT
/// after that time.
inline Finished run_program(const std::vector<std::string>& arguments,
                            const std::filesystem::path& folder,
                            std::chrono::milliseconds interrupt_after = {}) {
  const TemporaryFolder streams;
  const std::string out = streams.file("out"), err = streams.file("err");
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    const int out_file = open(out.c_str(), O_WRONLY | O_CREAT, 0600);
    const int err_file = open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    if (dup2(out_file, 1) < 0 || dup2(err_file, 2) < 0 || chdir(folder.c_str()) != 0) _exit(126);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  if (interrupt_after.count() > 0) {
    std::this_thread::sleep_for(interrupt_after);
    kill(child, SIGINT);
  }
  int status = 0;
  struct rusage usage {};
  if (wait4(child, &status, 0, &usage) != child) throw std::runtime_error("wait4 failed");
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, read_file(out), read_file(err), static_cast<std::size_t>(usage.ru_maxrss) * 1024};
}

#ifdef RAYSHEAF_APP
/// Runs `raysheaf ARGUMENTS...` in `folder`.
inline Finished raysheaf_app(std::vector<std::string> arguments, const TemporaryFolder& folder,
                             std::chrono::milliseconds interrupt_after = {}) {
  arguments.insert(arguments.begin(), RAYSHEAF_APP);
  return run_program(arguments, folder.path(), interrupt_after);
}
#endif

}  // namespace raysheaf::test
