// The statements of OBJ text.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/text_lines.h"

namespace raysheaf::io {

/// Goes from one logical line to the next. A backslash at the end joins two lines, but not in a
/// comment, and not if it is the last letter of a name.
class ObjLines {
 public:
  explicit ObjLines(std::string_view text) : text_(text) {}

  /// False after the last line.
  [[nodiscard]] bool next();
  /// The first word in lower case; empty for blank lines and comments.
  [[nodiscard]] const std::string& keyword() const { return keyword_; }
  /// The rest of the line after the keyword. Comments are removed, except after names.
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }

 private:
  std::string_view text_;
  std::size_t line_ = 0, next_line_ = 1;
  std::string current_, keyword_;
  std::string_view rest_;
};

/// The indices of a vertex, a texture coordinate and a normal as written: they count from 1, or
/// backwards if negative. Those that are left out are `kNoIndex`.
using ObjReference = std::array<std::int64_t, 3>;
inline constexpr std::int64_t kNoIndex = INT64_MIN;

/// Reads "7", "-1/2", "3//4" or "1/2/3", perhaps with slashes at the end. False if it is malformed.
[[nodiscard]] bool read_reference(std::string_view word, ObjReference* reference);

}  // namespace raysheaf::io
