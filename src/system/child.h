// Programs that this one starts.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raysheaf::system {

/// The path of a program that a shell would start by this name; empty: there is none.
[[nodiscard]] std::string find_program(const std::string& name);

/// A running program. It is waited for at the end of its life.
class Child {
 public:
  enum class Input : std::uint8_t {
    kNone,
    kShared,  ///< what this program reads
    kPipe,    ///< what is written to the child; it ignores the terminal's interrupts
  };

  /// Starts `words[0]`, which is looked up as a shell does, with these arguments. `said`, if not
  /// empty, is a file that takes its output and its messages.
  Child(const std::vector<std::string>& words, Input input, const std::string& said = {});
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// An errno; 0: the program was started.
  [[nodiscard]] int failure() const { return failure_; }
  /// False if the child reads no more.
  [[nodiscard]] bool write(std::span<const std::uint8_t> bytes);
  /// Closes the pipe and waits. Returns the exit code, or 128 plus the signal that ended the child;
  /// -1 if there is none. If `is_stopped()` becomes true meanwhile, the child is asked to end.
  int wait(bool (*is_stopped)() = nullptr);

 private:
  int failure_ = 0;
  int pipe_ = -1;
  std::intptr_t process_ = -1;
};

}  // namespace raysheaf::system
