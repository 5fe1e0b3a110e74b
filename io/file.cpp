#include "io/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "io/file_parts.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace io {
namespace {

namespace fs = std::filesystem;

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

[[noreturn]] void fail(const std::string& verb, const std::string& path, int error) {
  throw system_error(verb, path, error);
}

/// Returns 0, or the errno of the step that failed.
int write_in_place(const std::string& path, std::span<const std::uint8_t> bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0) return errno;
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return file.close() ? 0 : errno;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const int lower = std::tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

std::string decode_percent(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escaped = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 &&
                         hex_digit(text[i + 2]) >= 0;
    if (escaped) {
      result += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

/// Whether the file was written to between the two calls of fstat. If another file was renamed over
/// it, the open file is still the old one.
bool changed(const struct stat& before, const struct stat& now) {
  return before.st_size != now.st_size || before.st_mtim.tv_sec != now.st_mtim.tv_sec ||
         before.st_mtim.tv_nsec != now.st_mtim.tv_nsec;
}

std::string own_link(int file) {
  return "/proc/self/fd/" + std::to_string(file);
}

bool is_no_name(const std::string& name) {
  return name.empty() || name.find('\0') != std::string::npos ||
         name.find(':') != std::string::npos;
}

bool climbs_out(const fs::path& path) {
  return std::any_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
}

}  // namespace

Error system_error(const std::string& verb, const std::string& place, int error) {
  return {ErrorCode::kIo, "cannot be " + verb + ": " + std::strerror(error), place};
}

std::string temporary_name(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  // Machines that share a folder may have processes with the same id.
  static const std::string began =
      std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  // Read for each name: after a fork the id differs, while all other parts are equal.
  const std::string process = std::to_string(::getpid());
  const std::string name =
      ".raysheaf." + process + "." + began + "." + std::to_string(counter++) + ".part";
  return (fs::path(path).parent_path() / name).string();
}

int open_without_name(const std::string& beside, int flags) {
#ifdef O_TMPFILE
  const int file = ::open(folder_of(beside).c_str(), O_TMPFILE | O_CLOEXEC | flags, 0666);
  // `give_name` needs this link.
  if (file >= 0 && ::access(own_link(file).c_str(), F_OK) == 0) return file;
  if (file >= 0) ::close(file);
#endif
  return -1;
}

bool give_name(int file, const std::string& name) {
  return ::linkat(AT_FDCWD, own_link(file).c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

Bytes read_file(const std::string& path) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) {
    if (errno == ENOENT || errno == ENOTDIR) {
      throw Error(ErrorCode::kNotFound, "no such file", path);
    }
    fail("read", path, errno);
  }
  struct stat status = {};
  if (::fstat(file.get(), &status) != 0) fail("read", path, errno);
  if (S_ISDIR(status.st_mode)) throw Error(ErrorCode::kIo, "is a folder, not a file", path);
  if (!S_ISREG(status.st_mode)) throw Error(ErrorCode::kIo, "is not a regular file", path);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > kMaxFileBytes) {
    throw Error(ErrorCode::kOutOfMemory, "is larger than 4 GiB, the most that is read", path);
  }
  Bytes bytes(size);
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = ::read(file.get(), bytes.data() + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("read", path, errno);
    if (got == 0) throw Error(ErrorCode::kIo, "became shorter while it was read", path);
    done += static_cast<std::size_t>(got);
  }
  struct stat now = {};
  if (::fstat(file.get(), &now) != 0) fail("read", path, errno);
  if (changed(status, now)) throw Error(ErrorCode::kIo, "was changed while it was read", path);
  return bytes;
}

bool file_exists(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) {
    // The path is a device or a pipe, which a rename would replace by a file.
    if (const int failure = write_in_place(path, bytes)) fail("written", path, failure);
    return;
  }
  FileWriter file(path);
  file.append(bytes);
  file.finish();
}

std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

std::vector<std::string> files_of(const SceneFile& file) {
  std::vector<std::string> files{file.path};
  if (file.names != nullptr) files.insert(files.end(), file.names->begin(), file.names->end());
  return files;
}

std::string resolve(const SceneFile& from, const std::string& uri, bool is_uri,
                    const std::string& place) {
  std::string name = is_uri ? decode_percent(uri) : uri;
  const auto path_of = [&] { return fs::path(folder_of(from.path)) / fs::path(name); };
  const bool turned = is_uri && name.find('\\') != name.npos && !file_exists(path_of().string());
  if (turned) std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path path(name);
  const bool leaves = is_no_name(name) ||
                      (path.is_absolute() && (is_uri || !from.allow_external)) ||
                      (climbs_out(path) && !from.allow_external);
  if (leaves) {
    throw Error(ErrorCode::kUnsupported,
                "\"" + uri.substr(0, 200) + "\" does not stay inside the file's folder", place);
  }
  if (turned && from.turned != nullptr) from.turned->insert(uri);
  std::string resolved = path_of().string();
  if (from.names != nullptr) from.names->insert(resolved);
  return resolved;
}

}  // namespace io

std::string where_links_end(const std::string& path) {
  constexpr int kMostLinks = 40;  // Linux follows as many
  std::filesystem::path target = path;
  std::error_code error;
  for (int i = 0; std::filesystem::is_symlink(std::filesystem::symlink_status(target, error));
       ++i) {
    if (i == kMostLinks) throw io::system_error("written", path, ELOOP);
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) throw io::system_error("written", path, error.value());
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

void write_text(const std::string& text, const std::string& path) {
  io::write_file(path, io::as_bytes(text));
}

}  // namespace raysheaf
