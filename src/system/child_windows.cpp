#include "system/child.h"

#include <windows.h>
// After the header that it needs.
#include <fcntl.h>
#include <io.h>

#include <cerrno>
#include <utility>

#include "system/files.h"
#include "system/paths.h"

namespace raysheaf::system {
namespace {

/// A word of a command line, as programs take it apart: backslashes count before quotes only.
std::string quoted(const std::string& word) {
  std::string text = "\"";
  std::size_t slashes = 0;
  for (const char c : word) {
    if (c == '"') text.append(slashes + 1, '\\');
    slashes = c == '\\' ? slashes + 1 : 0;
    text += c;
  }
  text.append(slashes, '\\');
  return text + '"';
}

/// A handle that closes itself.
struct Owned {
  HANDLE handle = nullptr;
  ~Owned() {
    if (handle != nullptr && handle != INVALID_HANDLE_VALUE) CloseHandle(handle);
  }
};

HANDLE opened(const std::wstring& path, DWORD access, DWORD which, SECURITY_ATTRIBUTES* inherited) {
  return CreateFileW(path.c_str(), access, FILE_SHARE_READ | FILE_SHARE_WRITE, inherited, which,
                     FILE_ATTRIBUTE_NORMAL, nullptr);
}

}  // namespace

std::string find_program(const std::string& name) {
  std::wstring path(1u << 15, L'\0');  // no path is longer
  path.resize(SearchPathW(nullptr, path_of(name).c_str(), L".exe", static_cast<DWORD>(path.size()),
                          path.data(), nullptr));
  return text_of(path);
}

Child::Child(const std::vector<std::string>& words, Input input, const std::string& said) {
  SECURITY_ATTRIBUTES inherited = {sizeof inherited, nullptr, TRUE};
  Owned in, out, end;
  if (input == Input::kPipe) {
    if (CreatePipe(&in.handle, &end.handle, &inherited, 0) == 0) failure_ = EMFILE;
    SetHandleInformation(end.handle, HANDLE_FLAG_INHERIT, 0);
  } else if (input == Input::kNone) {
    in.handle = opened(L"NUL", GENERIC_READ, OPEN_EXISTING, &inherited);
  }
  if (!said.empty())
    out.handle = opened(path_of(said).native(), GENERIC_WRITE, CREATE_ALWAYS, &inherited);
  STARTUPINFOW start = {};
  start.cb = sizeof start;
  start.dwFlags = STARTF_USESTDHANDLES;
  start.hStdInput = input == Input::kShared ? GetStdHandle(STD_INPUT_HANDLE) : in.handle;
  start.hStdOutput = said.empty() ? GetStdHandle(STD_OUTPUT_HANDLE) : out.handle;
  start.hStdError = said.empty() ? GetStdHandle(STD_ERROR_HANDLE) : out.handle;
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + quoted(word);
  std::wstring wide = path_of(line).native();
  PROCESS_INFORMATION started = {};
  const DWORD group = input == Input::kPipe ? CREATE_NEW_PROCESS_GROUP : 0;
  if (failure_ == 0 && CreateProcessW(nullptr, wide.data(), nullptr, nullptr, TRUE, group, nullptr,
                                      nullptr, &start, &started) == 0)
    failure_ = ENOENT;
  if (failure_ != 0) return;
  CloseHandle(started.hThread);
  process_ = reinterpret_cast<std::intptr_t>(started.hProcess);
  if (input == Input::kPipe)
    pipe_ = _open_osfhandle(reinterpret_cast<std::intptr_t>(std::exchange(end.handle, nullptr)),
                            _O_BINARY);
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
  if (pipe_ >= 0) _close(std::exchange(pipe_, -1));
  if (process_ < 0) return -1;
  const Owned process{reinterpret_cast<HANDLE>(std::exchange(process_, -1))};
  constexpr DWORD kLookAgainMs = 100;
  while (WaitForSingleObject(process.handle, kLookAgainMs) == WAIT_TIMEOUT)
    if (is_stopped != nullptr && is_stopped()) TerminateProcess(process.handle, 1);
  DWORD code = 0;
  GetExitCodeProcess(process.handle, &code);
  return static_cast<int>(code);
}

}  // namespace raysheaf::system
