#include "console.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

volatile std::sig_atomic_t interrupt_seen = 0;
bool silent_process = false;

extern "C" void on_interrupt(int) {
  interrupt_seen = 1;
}

}  // namespace

void print(std::string_view text) {
  if (silent_process) return;
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (written && std::fflush(stdout) == 0) return;
  if (errno == EPIPE) return;
  throw Error(ErrorCode::kIo, std::string("cannot write: ") + std::strerror(errno),
              "standard output");
}

void tell(std::string_view line) {
  if (silent_process) return;
  std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
}

void tell_error(std::string_view sentence) {
  tell("raysheaf: " + printable(sentence));
}

void be_silent(bool silent) {
  silent_process = silent;
}

bool is_silent() {
  return silent_process;
}

std::string printable(std::string_view text) {
  std::string safe(text);
  for (char& c : safe) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) c = '?';
  }
  return safe;
}

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() {
  return interrupt_seen != 0;
}

void stop_if_interrupted() {
  if (interrupted()) throw Error(ErrorCode::kCancelled, "interrupted");
}

void guard_streams() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) < 0)
      static_cast<void>(open("/dev/null", O_RDWR));  // takes its place
  }
}

}  // namespace raysheaf::app
