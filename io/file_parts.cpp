#include "io/file_parts.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "io/file.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::io {

void read_at(int file, std::uint64_t offset, std::span<std::uint8_t> out,
             const std::string& place) {
  while (!out.empty()) {
    const ssize_t got = ::pread(file, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw system_error("read", place, errno);
    if (got == 0) throw Error(ErrorCode::kIo, "the file became shorter while it was read", place);
    out = out.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

void write_at(int file, std::uint64_t offset, std::span<const std::uint8_t> bytes,
              const std::string& place) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) throw system_error("written", place, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    offset += static_cast<std::uint64_t>(put);
  }
}

FileReader::FileReader(const std::string& path)
    : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  const auto close_and = [this](auto error) {
    if (file_ >= 0) ::close(std::exchange(file_, -1));
    throw error;
  };
  if (file_ < 0 && (errno == ENOENT || errno == ENOTDIR))
    throw Error(ErrorCode::kNotFound, "no such file", path);
  struct stat status = {};
  if (file_ < 0 || ::fstat(file_, &status) != 0) close_and(system_error("read", path, errno));
  if (S_ISDIR(status.st_mode)) close_and(Error(ErrorCode::kIo, "is a folder, not a file", path));
  if (!S_ISREG(status.st_mode)) close_and(Error(ErrorCode::kIo, "is not a regular file", path));
  size_ = static_cast<std::uint64_t>(status.st_size);
}

FileReader::~FileReader() {
  if (file_ >= 0) ::close(file_);
}

void FileReader::read(std::uint64_t offset, std::span<std::uint8_t> out,
                      const std::string& place) const {
  read_at(file_, offset, out, place);
}

FileWriter::FileWriter(const std::string& path) : path_(path), target_(where_links_end(path)) {
  struct stat old = {}, target = {};
  const bool replaces = ::stat(path.c_str(), &old) == 0;
  if (replaces && S_ISDIR(old.st_mode)) throw system_error("written", path, EISDIR);
  if (replaces && !S_ISREG(old.st_mode))
    throw Error(ErrorCode::kIo, "cannot be written: it is not a regular file", path);
  // The target of a /proc link may have been removed, or its name may belong to another file now.
  if (replaces && (::stat(target_.c_str(), &target) != 0 || target.st_dev != old.st_dev ||
                   target.st_ino != old.st_ino))
    throw Error(ErrorCode::kIo, "cannot be written: the file there has no name", path);
  temporary_ = temporary_name(target_);
  file_ = open_without_name(target_, O_WRONLY);
  if (file_ < 0) {
    is_named_ = true;
    file_ = ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC | O_CREAT | O_EXCL, 0666);
  }
  if (file_ < 0) throw system_error("written", path, errno);
  // Copies the permissions of the old file before the first byte is written.
  if (replaces) static_cast<void>(::fchmod(file_, old.st_mode & 0777));
}

FileWriter::~FileWriter() {
  if (file_ < 0) return;
  ::close(file_);
  if (is_named_) ::unlink(temporary_.c_str());
}

void FileWriter::append(std::span<const std::uint8_t> bytes) {
  write_at(file_, size_, bytes, path_);
  size_ += bytes.size();
}

void FileWriter::overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  write_at(file_, offset, bytes, path_);
}

void FileWriter::finish() {
  int failure = is_named_ || give_name(file_, temporary_) ? 0 : errno;
  if (::close(std::exchange(file_, -1)) != 0 && failure == 0) failure = errno;
  if (failure == 0 && std::rename(temporary_.c_str(), target_.c_str()) != 0) failure = errno;
  if (failure == 0) return;
  ::unlink(temporary_.c_str());
  throw system_error("written", path_, failure);
}

}  // namespace raysheaf::io
