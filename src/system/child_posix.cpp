#include "system/child.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "system/files.h"

extern char** environ;

namespace raysheaf::system {

std::string find_program(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string program = (folder.empty() ? "." : folder) + "/" + name;
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  return {};
}

Child::Child(const std::vector<std::string>& words, Input input, const std::string& said) {
  int ends[2] = {-1, -1};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (input == Input::kPipe) {
    if (::pipe(ends) != 0) failure_ = errno;
    for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  } else if (input == Input::kNone) {
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  }
  if (!said.empty()) {
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, said.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  }
  std::vector<std::string> copies = words;
  std::vector<char*> argv;
  for (std::string& word : copies) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = -1;
  if (failure_ == 0)
    failure_ = posix_spawnp(&process, argv.front(), &actions, &attributes, argv.data(), environ);
  if (failure_ == 0) process_ = process;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (ends[0] >= 0) ::close(ends[0]);
  pipe_ = ends[1];
}

Child::~Child() {
  wait();
}

bool Child::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const std::int64_t written = write_next(pipe_, bytes);
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

int Child::wait(bool (*is_stopped)()) {
  if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
  if (process_ < 0) return -1;
  const auto process = static_cast<pid_t>(std::exchange(process_, -1));
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR)
    if (is_stopped != nullptr && is_stopped()) ::kill(process, SIGTERM);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace raysheaf::system
