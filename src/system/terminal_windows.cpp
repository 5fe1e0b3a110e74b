#include "system/terminal.h"

#include <windows.h>
// After the header that it needs.
#include <fcntl.h>
#include <io.h>

#include <csignal>
#include <initializer_list>

namespace raysheaf::system {

bool is_terminal(std::FILE* stream) {
  return _isatty(_fileno(stream)) != 0;
}

std::size_t columns_of(std::FILE* stream) {
  CONSOLE_SCREEN_BUFFER_INFO screen = {};
  auto* const handle = reinterpret_cast<HANDLE>(_get_osfhandle(_fileno(stream)));
  if (GetConsoleScreenBufferInfo(handle, &screen) == 0) return 0;
  return static_cast<std::size_t>(screen.srWindow.Right - screen.srWindow.Left + 1);
}

/// Windows forgets a handler when it calls it.
void catch_stops(void (*on_stop)(int)) {
  static void (*kept)(int) = nullptr;
  kept = on_stop;
  const auto again = [](int signal) {
    std::signal(signal, SIG_IGN);
    catch_stops(kept);
    kept(signal);
  };
  for (const int signal : {SIGINT, SIGBREAK, SIGTERM}) std::signal(signal, again);
}

void end_by(int signal) {
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void guard_streams() {
  for (std::FILE* stream : {stdin, stdout, stderr})
    if (_fileno(stream) >= 0) static_cast<void>(_setmode(_fileno(stream), _O_BINARY));
}

}  // namespace raysheaf::system
