#include "system/files.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>

#include "system/paths.h"

namespace raysheaf::system {
namespace {

FileState state_from(const struct stat& status) {
#ifdef __APPLE__
  const timespec& written = status.st_mtimespec;
#else
  const timespec& written = status.st_mtim;
#endif
  using enum FileState::Kind;
  return {S_ISREG(status.st_mode)   ? kRegular
          : S_ISDIR(status.st_mode) ? kFolder
                                    : kOther,
          static_cast<std::uint64_t>(status.st_size),
          std::int64_t{written.tv_sec} * 1'000'000'000 + written.tv_nsec,
          static_cast<std::uint64_t>(status.st_dev),
          static_cast<std::uint64_t>(status.st_ino),
          static_cast<unsigned>(status.st_mode) & 0777u};
}

/// `call()` until no signal interrupts it.
template <class Call>
std::int64_t repeated(const Call& call) {
  std::int64_t result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// The link by which the system finds an open file that has no name.
std::string link_to(int file) {
  return "/proc/self/fd/" + std::to_string(file);
}

int open_without_name([[maybe_unused]] const std::string& folder, [[maybe_unused]] int flags) {
#ifdef O_TMPFILE
  return ::open(folder.c_str(), O_TMPFILE | O_CLOEXEC | flags, 0666);
#else
  errno = EOPNOTSUPP;
  return -1;
#endif
}

}  // namespace

std::filesystem::path path_of(const std::string& text) {
  return text;
}
std::string text_of(const std::filesystem::path& path) {
  return path.string();
}
bool has_special_name(const std::filesystem::path& /*path*/) {
  return false;
}

int open_file(const std::string& path, Access access) {
  constexpr int kFlags[] = {O_RDONLY | O_NONBLOCK, O_WRONLY, O_RDWR};
  return ::open(path.c_str(), kFlags[static_cast<int>(access)] | O_CLOEXEC);
}
int open_or_make_file(const std::string& path) {
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
}
int make_file(const std::string& path) {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

int make_file_without_name(const std::string& folder) {
  const int file = open_without_name(folder, O_WRONLY);
  if (file < 0 || ::access(link_to(file).c_str(), F_OK) == 0) return file;
  ::close(file);  // `give_name` would need the link
  return -1;
}
bool give_name(int file, const std::string& path) {
  return ::linkat(AT_FDCWD, link_to(file).c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

int make_scratch_file(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  int file = open_without_name(folder.empty() ? "." : folder, O_RDWR | O_EXCL);
  if (file >= 0) return file;
  file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file >= 0) ::unlink(path.c_str());
  return file;
}

bool close_file(int file) {
  return ::close(file) == 0;
}

std::optional<FileState> state_of(int file) {
  struct stat status = {};
  if (::fstat(file, &status) != 0) return std::nullopt;
  return state_from(status);
}
std::optional<FileState> state_of(const std::string& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return state_from(status);
}
void set_permissions(int file, unsigned permissions) {
  static_cast<void>(::fchmod(file, static_cast<mode_t>(permissions)));
}

std::int64_t read_some(int file, std::uint64_t offset, std::span<std::uint8_t> out) {
  return repeated(
      [&] { return ::pread(file, out.data(), out.size(), static_cast<off_t>(offset)); });
}
std::int64_t write_some(int file, std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  return repeated(
      [&] { return ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset)); });
}
std::int64_t write_next(int file, std::span<const std::uint8_t> bytes) {
  return repeated([&] { return ::write(file, bytes.data(), bytes.size()); });
}
bool resize_file(int file, std::uint64_t bytes) {
  return repeated([&] { return ::ftruncate(file, static_cast<off_t>(bytes)); }) == 0;
}

bool replace_file(const std::string& from, const std::string& to) {
  return std::rename(from.c_str(), to.c_str()) == 0;
}
bool remove_file(const std::string& path) {
  return ::unlink(path.c_str()) == 0;
}
std::string make_temporary_folder() {
  std::error_code failed;
  const std::filesystem::path all = std::filesystem::temp_directory_path(failed);
  std::string path = unused_name((all / "raysheaf-").string());
  return !failed && ::mkdir(path.c_str(), 0700) == 0 ? path : std::string();
}
bool can_make_files_in(const std::string& folder) {
  return ::access(folder.c_str(), W_OK | X_OK) == 0;
}

/// The directory iterator of libstdc++ 12 terminates the program if memory runs out.
void for_each_name(const std::string& folder, const std::function<void(const char*)>& take) {
  const auto close = [](DIR* opened) { closedir(opened); };
  const std::unique_ptr<DIR, decltype(close)> open(opendir(folder.c_str()), close);
  if (open == nullptr) return;
  while (const dirent* const entry = readdir(open.get())) take(entry->d_name);
}

}  // namespace raysheaf::system
