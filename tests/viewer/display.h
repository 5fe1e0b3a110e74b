// A virtual display, and the viewer on it.
#pragma once

#include <fcntl.h>

#include <optional>

#include "tests/support/process.h"

namespace raysheaf::test {

/// Runs Xvfb during its lifetime. `display` is empty if Xvfb is not installed.
class VirtualDisplay {
 public:
  VirtualDisplay() {
    int ends[2] = {-1, -1};
    if (pipe(ends) != 0) return;
    const std::string number_to = std::to_string(ends[1]);
    child_ = fork();
    if (child_ == 0) {
      const int nowhere = open("/dev/null", O_RDWR);
      dup2(nowhere, 1);
      dup2(nowhere, 2);
      close(ends[0]);
      execlp("Xvfb", "Xvfb", "-displayfd", number_to.c_str(), "-screen", "0", "1400x1000x24",
             "-nolisten", "tcp", nullptr);
      _exit(127);
    }
    close(ends[1]);
    std::string number;
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number += c;
    close(ends[0]);
    if (!number.empty()) display = ":" + number;
  }
  ~VirtualDisplay() {
    if (child_ <= 0) return;
    kill(child_, SIGTERM);
    waitpid(child_, nullptr, 0);
  }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  std::string display;

 private:
  pid_t child_ = -1;
};

/// Changes an environment variable during its lifetime.
class ScopedVariable {
 public:
  ScopedVariable(std::string name, const char* value) : name_(std::move(name)) {
    if (const char* old = std::getenv(name_.c_str())) old_ = old;
    set(value);
  }
  ~ScopedVariable() { set(old_ ? old_->c_str() : nullptr); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  void set(const char* value) const {
    if (value != nullptr) {
      setenv(name_.c_str(), value, 1);
    } else {
      unsetenv(name_.c_str());
    }
  }

  std::string name_;
  std::optional<std::string> old_;
};

}  // namespace raysheaf::test
