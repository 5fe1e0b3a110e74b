// The numbers behind a PLY header, one after the other.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "io/ply_header.h"

namespace raysheaf::io {

class PlyNumbers {
 public:
  PlyNumbers(std::span<const std::uint8_t> file, const PlyHeader& header)
      : bytes_(file), at_(header.bytes), format_(header.format) {}

  /// The next number. Doubles hold every integer of PLY exactly. Throws, naming `place`, where the
  /// file ends or an ASCII word is no number.
  [[nodiscard]] double next(PlyType type, const std::string& element, std::uint64_t index);
  /// A list's count: not negative, and the file is long enough for it.
  [[nodiscard]] std::uint64_t next_count(const PlyProperty& list, const std::string& element,
                                         std::uint64_t index);
  void skip(const PlyProperty& property, const std::string& element, std::uint64_t index);

 private:
  [[nodiscard]] double next_word(const std::string& element, std::uint64_t index);
  [[noreturn]] void refuse(const std::string& sentence, const std::string& element,
                           std::uint64_t index) const;

  std::span<const std::uint8_t> bytes_;
  std::size_t at_;
  PlyFormat format_;
};

}  // namespace raysheaf::io
