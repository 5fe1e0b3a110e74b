#include "apps/support/console.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "raysheaf/error.h"
#include "system/terminal.h"

namespace raysheaf::app {
namespace {

std::atomic<int> stop_signal{0};
std::atomic<std::int64_t> stop_time{0};
static_assert(std::atomic<int>::is_always_lock_free &&
              std::atomic<std::int64_t>::is_always_lock_free);
bool silent_process = false;

std::int64_t monotonic_ms() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

extern "C" void on_stop(int signal) {
  // One request may arrive twice: for the process, and for its group.
  constexpr std::int64_t kSameWishMs = 500;
  const int error = errno;
  if (stop_signal == 0) {
    stop_time = monotonic_ms();
    stop_signal = signal;
  } else if (monotonic_ms() - stop_time > kSameWishMs) {
    system::end_by(signal);
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
  const std::size_t columns = system::columns_of(stream);
  return columns == 0 ? kUsualColumns : columns;
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
  system::catch_stops(on_stop);
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

}  // namespace raysheaf::app
