#include "io/file_parts.h"

#include <cerrno>
#include <utility>

#include "io/file.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::io {

using Kind = system::FileState::Kind;

void read_at(int file, std::uint64_t offset, std::span<std::uint8_t> out,
             const std::string& place) {
  while (!out.empty()) {
    const std::int64_t got = system::read_some(file, offset, out);
    if (got < 0) throw system_error("read", place, errno);
    if (got == 0) throw Error(ErrorCode::kIo, "the file became shorter while it was read", place);
    out = out.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

void write_at(int file, std::uint64_t offset, std::span<const std::uint8_t> bytes,
              const std::string& place) {
  while (!bytes.empty()) {
    const std::int64_t put = system::write_some(file, offset, bytes);
    if (put < 0) throw system_error("written", place, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    offset += static_cast<std::uint64_t>(put);
  }
}

FileReader::FileReader(const std::string& path)
    : file_(system::open_file(path, system::Access::kRead)) {
  const auto close_and = [this](auto error) {
    if (file_ >= 0) static_cast<void>(system::close_file(std::exchange(file_, -1)));
    throw error;
  };
  if (file_ < 0 && (errno == ENOENT || errno == ENOTDIR))
    throw Error(ErrorCode::kNotFound, "no such file", path);
  const auto state = file_ < 0 ? std::nullopt : system::state_of(file_);
  if (!state) close_and(system_error("read", path, errno));
  if (state->kind == Kind::kFolder)
    close_and(Error(ErrorCode::kIo, "is a folder, not a file", path));
  if (state->kind != Kind::kRegular)
    close_and(Error(ErrorCode::kIo, "is not a regular file", path));
  opened_ = *state;
}

FileReader::~FileReader() {
  if (file_ >= 0) static_cast<void>(system::close_file(file_));
}

void FileReader::read(std::uint64_t offset, std::span<std::uint8_t> out,
                      const std::string& place) const {
  read_at(file_, offset, out, place);
}

bool FileReader::was_changed() const {
  const auto now = system::state_of(file_);
  return !now || now->bytes != opened_.bytes || now->written_ns != opened_.written_ns;
}

FileWriter::FileWriter(const std::string& path) : path_(path), target_(where_links_end(path)) {
  const auto old = system::state_of(path);
  if (old && old->kind == Kind::kFolder) throw system_error("written", path, EISDIR);
  if (old && old->kind != Kind::kRegular)
    throw Error(ErrorCode::kIo, "cannot be written: it is not a regular file", path);
  // The target of a /proc link may have been removed, or its name may belong to another file now.
  const auto target = old ? system::state_of(target_) : std::nullopt;
  if (old && !(target && target->volume == old->volume && target->number == old->number))
    throw Error(ErrorCode::kIo, "cannot be written: the file there has no name", path);
  temporary_ = temporary_name(target_);
  file_ = system::make_file_without_name(folder_of(target_));
  if (file_ < 0) {
    is_named_ = true;
    file_ = system::make_file(temporary_);
  }
  if (file_ < 0) throw system_error("written", path, errno);
  // Copies the permissions of the old file before the first byte is written.
  if (old) system::set_permissions(file_, old->permissions);
}

FileWriter::~FileWriter() {
  if (file_ < 0) return;
  static_cast<void>(system::close_file(file_));
  if (is_named_) system::remove_file(temporary_);
}

void FileWriter::append(std::span<const std::uint8_t> bytes) {
  write_at(file_, size_, bytes, path_);
  size_ += bytes.size();
}

void FileWriter::overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  write_at(file_, offset, bytes, path_);
}

void FileWriter::finish() {
  int failure = is_named_ || system::give_name(file_, temporary_) ? 0 : errno;
  if (!system::close_file(std::exchange(file_, -1)) && failure == 0) failure = errno;
  if (failure == 0 && !system::replace_file(temporary_, target_)) failure = errno;
  if (failure == 0) return;
  system::remove_file(temporary_);
  throw system_error("written", path_, failure);
}

}  // namespace raysheaf::io
