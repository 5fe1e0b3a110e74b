#include "apps/support/console.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <system_error>

#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

std::atomic<int> stop_signal{0};
std::atomic<std::int64_t> stop_time{0};
static_assert(std::atomic<int>::is_always_lock_free &&
              std::atomic<std::int64_t>::is_always_lock_free);
bool silent_process = false;

std::int64_t monotonic_ms() {
  struct timespec now {};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

extern "C" void on_stop(int signal) {
  // One request may arrive twice: for the process, and for its group.
  constexpr std::int64_t kSameWishMs = 500;
  const int error = errno;
  if (stop_signal == 0) {
    stop_time = monotonic_ms();
    stop_signal = signal;
  } else if (monotonic_ms() - stop_time > kSameWishMs) {
    std::signal(signal, SIG_DFL);
    raise(signal);
  }
  errno = error;
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

void tell_warnings(const std::vector<std::string>& warnings) {
  constexpr std::size_t kMost = 8;
  for (std::size_t i = 0; i < std::min(warnings.size(), kMost); ++i)
    tell("warning: " + printable(warnings[i]));
  if (warnings.size() > kMost)
    tell("warning: " + std::to_string(warnings.size() - kMost) +
         " more; \"raysheaf info --all\" prints all of them");
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

std::size_t terminal_columns(std::FILE* stream) {
  constexpr std::size_t kUsualColumns = 80;
  winsize size{};
  if (ioctl(fileno(stream), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualColumns;
  return size.ws_col;
}

std::size_t output_columns() {
  const char* given = std::getenv("COLUMNS");
  const std::string_view text = given == nullptr ? "" : given;
  std::size_t columns = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), columns);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && columns > 0 ? columns : terminal_columns(stdout);
}

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_stop;
  sigaction(SIGINT, &action, nullptr);
  for (const int signal : {SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);  // nohup stays nohup
  }
}

bool interrupted() {
  return stop_signal != 0;
}

int interrupted_code() {
  const int signal = stop_signal;
  return 128 + (signal != 0 ? signal : SIGINT);
}

void stop_if_interrupted() {
  if (interrupted()) throw Error(ErrorCode::kCancelled, "interrupted");
}

void guard_streams() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    // Takes the place of the closed stream. Output written there is lost, which is an error;
    // messages may be lost.
    static_cast<void>(open("/dev/null", stream == STDOUT_FILENO ? O_RDONLY : O_RDWR));
  }
}

}  // namespace raysheaf::app
