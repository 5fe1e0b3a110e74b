// Reads the numbers after a PLY header in sequence.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "io/file_parts.h"
#include "io/ply_header.h"

namespace raysheaf::io {

class PlyNumbers {
 public:
  PlyNumbers(std::span<const std::uint8_t> file, const PlyHeader& header)
      : bytes_(file), at_(header.bytes), format_(header.format) {}
  /// For a binary file that is read in windows.
  PlyNumbers(const FileReader& file, const PlyHeader& header)
      : file_(&file), end_(header.bytes), format_(header.format) {}

  /// The next number. Doubles hold every integer of PLY exactly. Throws, naming `place`, if the
  /// file ends or an ASCII word is not a number.
  [[nodiscard]] double next(PlyType type, const std::string& element, std::uint64_t index);
  /// A list's count. Throws if it is negative or the file is too short for it.
  [[nodiscard]] std::uint64_t next_count(const PlyProperty& list, const std::string& element,
                                         std::uint64_t index);
  void skip(const PlyProperty& property, const std::string& element, std::uint64_t index);
  /// Whether a number of an ASCII file had a comma (see `read_number`).
  [[nodiscard]] bool has_commas() const { return has_commas_; }

 private:
  /// Whether there are `count` bytes (at most 8) at `at_`.
  [[nodiscard]] bool has(std::size_t count);
  [[nodiscard]] std::uint64_t bytes_left() const;
  [[nodiscard]] double next_word(const std::string& element, std::uint64_t index);
  [[noreturn]] void refuse(const std::string& sentence, const std::string& element,
                           std::uint64_t index) const;

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  const FileReader* file_ = nullptr;
  std::vector<std::uint8_t> window_;
  std::uint64_t end_ = 0;  ///< the window's end in the file
  PlyFormat format_;
  bool has_commas_ = false;
};

}  // namespace raysheaf::io
