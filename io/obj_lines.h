// Reads OBJ text line by line and checks it: the parser would silently read a malformed number or
// reference as zero.
#pragma once

#include <optional>
#include <span>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include "io/file.h"
#include "raysheaf/types.h"

namespace raysheaf::io {

/// Delivers one logical line at a time, so that in the parser's callbacks `line()` is the current
/// line's number. A backslash at the end joins two lines, but not in a comment, and not if it is
/// the last letter of a name. Throws `Error` with a place like "line 17".
class ObjLines : public std::streambuf {
 public:
  explicit ObjLines(std::string_view text) : text_(text) {}

  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
  /// The colour of the current vertex as written: three numbers after its position.
  [[nodiscard]] const std::optional<Vec3>& color() const { return color_; }
  /// The names on mtllib lines since the last call; the parser does not get these lines.
  [[nodiscard]] std::vector<std::string> take_libraries() { return std::move(libraries_); }
  [[nodiscard]] bool had_lines_or_points() const { return lines_or_points_; }
  [[nodiscard]] bool had_curves() const { return curves_; }
  [[nodiscard]] bool had_short_faces() const { return short_faces_; }

 protected:
  int_type underflow() override;

 private:
  bool next_line();
  void check_line();
  void check_numbers(std::string_view rest, std::size_t least);
  void check_face(std::string_view rest);

  std::string_view text_;
  std::size_t line_ = 0, next_line_ = 1;
  std::string current_;
  std::optional<Vec3> color_;
  std::vector<std::string> libraries_;
  bool lines_or_points_ = false, curves_ = false, short_faces_ = false;
};

/// A file's text without the UTF-8 byte order mark. Throws `Error` (kUnsupported) for UTF-16.
[[nodiscard]] std::string_view text_of(std::span<const std::uint8_t> file);
/// Removes the first line and its end ("\n", "\r" or "\r\n") from `text`, which must not be empty.
[[nodiscard]] std::string_view take_line(std::string_view& text);
/// Removes the first word from a line.
std::string_view take_word(std::string_view& text);
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text);
[[nodiscard]] std::string_view trim(std::string_view text);
/// Whether the text is one decimal number ("-1.5e3", ".5", "2.").
[[nodiscard]] bool is_number(std::string_view text);
/// The value of a text for which `is_number` is true. Beyond the range of double, it is 0 or
/// infinite, depending on the exponent.
[[nodiscard]] double number_of(std::string_view number);

}  // namespace raysheaf::io
