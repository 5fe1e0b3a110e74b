// Bytes of a glTF file and of its buffers, in memory or in a file.
#pragma once

#include <span>
#include <string>

#include "io/file.h"
#include "io/file_parts.h"

namespace raysheaf::io {

/// A file that is read in windows. Errors name `place` in addition to the scene's file.
struct GltfFile {
  GltfFile(const std::string& path, std::string named) : reader(path), place(std::move(named)) {}
  FileReader reader;
  std::string place;
};

/// A view of bytes in memory or in a file, which must outlive it.
class GltfBytes {
 public:
  GltfBytes() = default;
  explicit GltfBytes(std::span<const std::uint8_t> held) : held_(held), size_(held.size()) {}
  explicit GltfBytes(const GltfFile& file) : file_(&file), size_(file.reader.size()) {}

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] bool is_held() const { return file_ == nullptr; }
  [[nodiscard]] GltfBytes subspan(std::uint64_t offset, std::uint64_t size) const {
    GltfBytes part = *this;
    part.size_ = size;
    if (is_held())
      part.held_ = held_.subspan(offset, size);
    else
      part.offset_ += offset;
    return part;
  }
  [[nodiscard]] GltfBytes subspan(std::uint64_t offset) const {
    return subspan(offset, size_ - offset);
  }
  /// The bytes [offset, offset + count), which must exist: either in place, or read into `scratch`.
  [[nodiscard]] std::span<const std::uint8_t> read(std::uint64_t offset, std::size_t count,
                                                   Bytes& scratch) const {
    if (is_held()) return held_.subspan(offset, count);
    scratch.resize(count);
    file_->reader.read(offset_ + offset, scratch, file_->place);
    return scratch;
  }

 private:
  std::span<const std::uint8_t> held_;
  const GltfFile* file_ = nullptr;
  std::uint64_t offset_ = 0, size_ = 0;
};

}  // namespace raysheaf::io
