// Files that are larger than memory: read and written in parts. Errors name the file.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace raysheaf::io {

/// All of `out`, from `offset` on, of an open file; all of `bytes` to there. Throw kIo, also where
/// the file ends before; `place` is what the error names.
void read_at(int file, std::uint64_t offset, std::span<std::uint8_t> out, const std::string& place);
void write_at(int file, std::uint64_t offset, std::span<const std::uint8_t> bytes,
              const std::string& place);

/// A regular file that is open for reading, by any number of threads at once.
class FileReader {
 public:
  /// Throws kNotFound where there is none, kIo where it cannot be read.
  explicit FileReader(const std::string& path);
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }  ///< when it was opened
  /// All of `out`, from `offset` on. Throws kIo with `place` where it cannot be read, or ends
  /// before.
  void read(std::uint64_t offset, std::span<std::uint8_t> out, const std::string& place) const;

 private:
  int file_ = -1;
  std::uint64_t size_ = 0;
};

/// Written without a name, or beside its own where the system has no files without one; `finish`
/// renames it: the old file stands until then. Without `finish` nothing is left. Throws kIo.
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
  bool is_named_ = false;  // what is not whole
  std::uint64_t size_ = 0;
};

}  // namespace raysheaf::io
