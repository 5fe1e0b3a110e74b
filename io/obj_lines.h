// OBJ text, line by line, checked on the way: what the parser gets holds no malformed number or
// reference, which it would read as zero without a word.
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

/// Hands out one logical line at a time (a backslash at the end joins two, but not in a comment,
/// nor where it is the last letter of a name), so that in the parser's callbacks `line()` is the
/// number of the line at hand. Throws `Error` with place "line 17".
class ObjLines : public std::streambuf {
 public:
  explicit ObjLines(std::string_view text) : text_(text) {}

  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
  /// The colour of the vertex at hand, as it is written: three numbers behind its place.
  [[nodiscard]] const std::optional<Vec3>& color() const { return color_; }
  /// The rest of each mtllib line since the last call; the parser does not see these lines.
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

/// A file's text, without the mark that may begin UTF-8. Throws `Error` (kUnsupported) for UTF-16.
[[nodiscard]] std::string_view text_of(std::span<const std::uint8_t> file);
/// Takes the first line off `text`, which is not empty, with its end: "\n", "\r" or "\r\n".
[[nodiscard]] std::string_view take_line(std::string_view& text);
/// Takes the first word off a line.
std::string_view take_word(std::string_view& text);
/// The words of a line.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text);
[[nodiscard]] std::string_view trim(std::string_view text);
/// Whether the text is one decimal number ("-1.5e3", ".5", "2.").
[[nodiscard]] bool is_number(std::string_view text);
/// Of such a text; what is beyond a double is 0 or infinite, as its exponent says.
[[nodiscard]] double number_of(std::string_view number);

}  // namespace raysheaf::io
