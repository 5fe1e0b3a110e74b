// Reads and writes parts of files that may be larger than memory. Errors name the file.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "system/files.h"

namespace raysheaf::io {

/// These read or write all of a span at `offset` of an open file. They throw kIo, also if the file
/// ends too early; `place` is the error's place.
void read_at(int file, std::uint64_t offset, std::span<std::uint8_t> out, const std::string& place);
void write_at(int file, std::uint64_t offset, std::span<const std::uint8_t> bytes,
              const std::string& place);

/// A regular file that is open for reading. Any number of threads may read it at once.
class FileReader {
 public:
  /// Throws kNotFound if there is no such file, kIo if it cannot be read.
  explicit FileReader(const std::string& path);
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  [[nodiscard]] std::uint64_t size() const { return opened_.bytes; }  ///< at the time of opening
  /// Whether the file was written to since it was opened. If another file was renamed over it, the
  /// open file is still the old one.
  [[nodiscard]] bool was_changed() const;
  /// Fills `out` from `offset` on. Throws kIo with `place` if the file cannot be read or ends too
  /// early.
  void read(std::uint64_t offset, std::span<std::uint8_t> out, const std::string& place) const;

 private:
  int file_ = -1;
  system::FileState opened_;
};

/// Writes a file without a name, or under a temporary name if the system needs one. `finish` gives
/// it its real name; until then the old file stays. Without `finish`, nothing is left. Throws kIo.
class FileWriter {
 public:
  explicit FileWriter(const std::string& path);
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void append(std::span<const std::uint8_t> bytes);
  void overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  void finish();
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  std::string path_, target_, temporary_;
  int file_ = -1;
  bool is_named_ = false;  // the unfinished file has a temporary name
  std::uint64_t size_ = 0;
};

}  // namespace raysheaf::io
