#include "system/files.h"

#include <windows.h>
// After the header that it needs.
#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cwctype>
#include <limits>
#include <utility>

#include "system/paths.h"

namespace raysheaf::system {
namespace {

/// Sets errno from the error of the last call.
int set_errno() {
  switch (GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_PATHNAME:
    case ERROR_BAD_NETPATH:
    case ERROR_INVALID_DRIVE:
      errno = ENOENT;
      break;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      errno = EEXIST;
      break;
    case ERROR_ACCESS_DENIED:
    case ERROR_WRITE_PROTECT:
      errno = EACCES;
      break;
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
      errno = EBUSY;
      break;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      errno = ENOSPC;
      break;
    case ERROR_FILENAME_EXCED_RANGE:
      errno = ENAMETOOLONG;
      break;
    case ERROR_NOT_ENOUGH_MEMORY:
      errno = ENOMEM;
      break;
    default:
      errno = EIO;
  }
  return -1;
}

HANDLE handle_of(int file) {
  return reinterpret_cast<HANDLE>(_get_osfhandle(file));
}

int opened(const std::string& path, DWORD access, DWORD which, DWORD attributes) {
  constexpr DWORD kShared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
  // Backup semantics let folders be opened, so that callers can refuse them as folders.
  HANDLE handle = CreateFileW(path_of(path).c_str(), access, kShared, nullptr, which,
                              attributes | FILE_FLAG_BACKUP_SEMANTICS, nullptr);
  if (handle == INVALID_HANDLE_VALUE) return set_errno();
  const int file = _open_osfhandle(reinterpret_cast<std::intptr_t>(handle), _O_BINARY);
  if (file < 0) CloseHandle(handle);
  return file;
}

FileState state_from(HANDLE handle) {
  using enum FileState::Kind;
  BY_HANDLE_FILE_INFORMATION about = {};
  if (GetFileType(handle) != FILE_TYPE_DISK || GetFileInformationByHandle(handle, &about) == 0)
    return {};
  const auto joined = [](DWORD high, DWORD low) { return std::uint64_t{high} << 32 | low; };
  const FILETIME& written = about.ftLastWriteTime;
  return {(about.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? kFolder : kRegular,
          joined(about.nFileSizeHigh, about.nFileSizeLow),
          static_cast<std::int64_t>(joined(written.dwHighDateTime, written.dwLowDateTime)) * 100,
          about.dwVolumeSerialNumber,
          joined(about.nFileIndexHigh, about.nFileIndexLow),
          0};
}

/// One call of ReadFile or WriteFile.
template <class Call, class Byte>
std::int64_t moved(const Call& call, int file, std::uint64_t offset, std::span<Byte> bytes) {
  OVERLAPPED at = {};
  at.Offset = static_cast<DWORD>(offset);
  at.OffsetHigh = static_cast<DWORD>(offset >> 32);
  const auto most = static_cast<DWORD>(std::min<std::size_t>(bytes.size(), std::size_t{1} << 30));
  DWORD done = 0;
  if (call(handle_of(file), bytes.data(), most, &done, &at) != 0) return done;
  return GetLastError() == ERROR_HANDLE_EOF ? 0 : set_errno();
}

/// Names that stand for a device in every folder, with any ending.
bool is_device(std::wstring name) {
  name.erase(std::min(name.find_first_of(L".:"), name.size()));
  while (!name.empty() && name.back() == L' ') name.pop_back();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](wchar_t c) { return std::towupper(c); });
  for (const wchar_t* one : {L"CON", L"PRN", L"AUX", L"NUL", L"CONIN$", L"CONOUT$"})
    if (name == one) return true;
  // COM1 to COM9, LPT1 to LPT9, and the same with a superscript 1, 2 or 3
  return name.size() == 4 && (name.starts_with(L"COM") || name.starts_with(L"LPT")) &&
         std::wstring_view(L"0123456789\u00b9\u00b2\u00b3").find(name[3]) !=
             std::wstring_view::npos;
}

}  // namespace

std::filesystem::path path_of(const std::string& text) {
  const int bytes = static_cast<int>(std::min<std::size_t>(text.size(), 1u << 20));
  std::wstring wide(static_cast<std::size_t>(bytes), L'\0');  // never more units than bytes
  const int units =
      bytes == 0 ? 0 : MultiByteToWideChar(CP_UTF8, 0, text.data(), bytes, wide.data(), bytes);
  wide.resize(static_cast<std::size_t>(units));
  return wide;
}

std::string text_of(const std::filesystem::path& path) {
  const std::wstring& wide = path.native();
  const int units = static_cast<int>(std::min<std::size_t>(wide.size(), 1u << 20));
  std::string text(std::size_t{3} * static_cast<std::size_t>(units),
                   '\0');  // at most three bytes each
  const int bytes = units == 0 ? 0
                               : WideCharToMultiByte(CP_UTF8, 0, wide.data(), units, text.data(),
                                                     3 * units, nullptr, nullptr);
  text.resize(static_cast<std::size_t>(bytes));
  return text;
}

bool has_special_name(const std::filesystem::path& path) {
  return std::any_of(path.begin(), path.end(), [](const std::filesystem::path& part) {
    const std::wstring& name = part.native();
    if (name.empty() || name == L"." || name == L"..") return false;
    return name.back() == L'.' || name.back() == L' ' || is_device(name);
  });
}

int open_file(const std::string& path, Access access) {
  constexpr DWORD kAccess[] = {GENERIC_READ, GENERIC_WRITE, GENERIC_READ | GENERIC_WRITE};
  return opened(path, kAccess[static_cast<int>(access)], OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL);
}
int open_or_make_file(const std::string& path) {
  return opened(path, GENERIC_READ | GENERIC_WRITE, OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL);
}
int make_file(const std::string& path) {
  return opened(path, GENERIC_WRITE, CREATE_NEW, FILE_ATTRIBUTE_NORMAL);
}

int make_file_without_name(const std::string& /*folder*/) {
  errno = EOPNOTSUPP;
  return -1;
}
bool give_name(int /*file*/, const std::string& /*path*/) {
  errno = EOPNOTSUPP;
  return false;
}

int make_scratch_file(const std::string& path) {
  return opened(path, GENERIC_READ | GENERIC_WRITE | DELETE, CREATE_NEW,
                FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE);
}

bool close_file(int file) {
  return _close(file) == 0;
}

std::optional<FileState> state_of(int file) {
  return state_from(handle_of(file));
}
std::optional<FileState> state_of(const std::string& path) {
  const int file = opened(path, 0, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL);
  if (file < 0) return std::nullopt;
  const FileState state = state_from(handle_of(file));
  _close(file);
  return state;
}
void set_permissions(int /*file*/, unsigned /*permissions*/) {}

std::int64_t read_some(int file, std::uint64_t offset, std::span<std::uint8_t> out) {
  return moved(ReadFile, file, offset, out);
}
std::int64_t write_some(int file, std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  return moved(WriteFile, file, offset, bytes);
}
std::int64_t write_next(int file, std::span<const std::uint8_t> bytes) {
  DWORD done = 0;
  const auto most = static_cast<DWORD>(std::min<std::size_t>(bytes.size(), std::size_t{1} << 30));
  return WriteFile(handle_of(file), bytes.data(), most, &done, nullptr) != 0 ? done : set_errno();
}
bool resize_file(int file, std::uint64_t bytes) {
  FILE_END_OF_FILE_INFO end = {};
  end.EndOfFile.QuadPart = static_cast<LONGLONG>(bytes);
  if (SetFileInformationByHandle(handle_of(file), FileEndOfFileInfo, &end, sizeof end) != 0)
    return true;
  set_errno();
  return false;
}

bool replace_file(const std::string& from, const std::string& to) {
  if (MoveFileExW(path_of(from).c_str(), path_of(to).c_str(), MOVEFILE_REPLACE_EXISTING) != 0)
    return true;
  set_errno();
  return false;
}
bool remove_file(const std::string& path) {
  if (DeleteFileW(path_of(path).c_str()) != 0) return true;
  set_errno();
  return false;
}
std::string make_temporary_folder() {
  std::error_code failed;
  const std::filesystem::path all = std::filesystem::temp_directory_path(failed);
  std::string path = unused_name(text_of(all / "raysheaf-"));
  if (!failed && CreateDirectoryW(path_of(path).c_str(), nullptr) != 0) return path;
  set_errno();
  return {};
}
bool can_make_files_in(const std::string& folder) {
  const std::optional<FileState> state = state_of(folder);
  if (!state) return false;
  if (state->kind == FileState::Kind::kFolder) return true;
  errno = ENOTDIR;
  return false;
}

void for_each_name(const std::string& folder, const std::function<void(const char*)>& take) {
  struct Search {
    HANDLE handle;
    ~Search() {
      if (handle != INVALID_HANDLE_VALUE) FindClose(handle);
    }
  };
  WIN32_FIND_DATAW entry;
  const Search search{FindFirstFileW((path_of(folder) / L"*").c_str(), &entry)};
  if (search.handle == INVALID_HANDLE_VALUE) return;
  do take(text_of(entry.cFileName).c_str());
  while (FindNextFileW(search.handle, &entry) != 0);
}

}  // namespace raysheaf::system
