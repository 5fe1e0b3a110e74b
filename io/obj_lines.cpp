#include "io/obj_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "io/gltf_rules.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::size_t skip_digits(std::string_view text, std::size_t i) {
  while (i < text.size() && is_digit(text[i])) ++i;
  return i;
}
std::size_t skip_sign(std::string_view text, std::size_t i) {
  return i < text.size() && (text[i] == '+' || text[i] == '-') ? i + 1 : i;
}

/// A loop by hand: `find_first_of` calls a function for each character.
std::size_t line_size(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size() && text[i] != '\n' && text[i] != '\r') ++i;
  return i;
}

/// In names, '#' is an ordinary character; after numbers it begins a comment.
bool has_numbers(std::string_view keyword) {
  return keyword == "v" || keyword == "vn" || keyword == "vt" || keyword == "f";
}

/// The kind of a line, by its first word: it determines the meaning of '#' and of a backslash at
/// the end.
enum class LineKind { kNone, kComment, kNames, kNumbers };

/// `part` is a piece of a line; a backslash at its end is ignored. Names of files, groups and
/// materials may contain '#' and backslashes; in other lines '#' begins a comment.
LineKind kind_of(std::string_view part) {
  constexpr std::string_view kNamed[] = {"g",      "o",      "usemtl",     "mtllib",
                                         "usemap", "maplib", "shadow_obj", "trace_obj"};
  const bool cut = part.ends_with('\\');
  if (cut) part.remove_suffix(1);
  const std::string_view keyword = take_word(part);
  if (keyword.empty()) return LineKind::kNone;
  if (keyword.starts_with('#')) return LineKind::kComment;
  const bool whole = !cut || !part.empty();
  const bool named = std::find(std::begin(kNamed), std::end(kNamed), keyword) != std::end(kNamed);
  return whole && named ? LineKind::kNames : LineKind::kNumbers;
}

/// Whether the line of this kind, whose last piece is `part`, continues on the next line. Comments
/// do not. A name may end with a backslash, as folders do on Windows: in such lines only a separate
/// backslash continues the line.
bool goes_on(LineKind kind, std::string_view part) {
  if (!part.ends_with('\\') || kind == LineKind::kComment) return false;
  if (kind == LineKind::kNumbers) return part.find('#') == part.npos;
  return kind != LineKind::kNames || part.ends_with(" \\") || part.ends_with("\t\\");
}

enum class Reference { kRight, kMalformed, kZero, kTooLarge };

/// "7", "-1/2", "3//4" or "1/2/3".
Reference check_reference(std::string_view word) {
  std::size_t i = 0;
  for (int part = 0; part < 3; ++part) {
    const std::size_t first = skip_sign(word, i), last = skip_digits(word, first);
    const bool may_be_empty = part == 1 && first == i && last < word.size() && word[last] == '/';
    if (last == first && !may_be_empty) return Reference::kMalformed;
    if (last - first > 9) return Reference::kTooLarge;
    const std::string_view digits = word.substr(first, last - first);
    if (!digits.empty() && digits.find_first_not_of('0') == digits.npos) return Reference::kZero;
    if (last == word.size()) return Reference::kRight;
    if (word[last] != '/' || part == 2) return Reference::kMalformed;
    i = last + 1;
    // "7/" and "7/2/" have no further reference.
    if (i == word.size()) return Reference::kRight;
  }
  return Reference::kMalformed;
}

/// A colour component, clamped to 0 and 255.
float value_of(std::string_view number) {
  return static_cast<float>(std::clamp(number_of(number), 0.0, 255.0));
}

std::string quoted(std::string_view word) {
  return "\"" + printable(std::string(word)) + "\"";
}

}  // namespace

std::string_view text_of(std::span<const std::uint8_t> file) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    refuse("the text is UTF-16; UTF-8 is read", {}, ErrorCode::kUnsupported);
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

std::string_view take_word(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_blank(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = line_size(text);
  const std::string_view line = text.substr(0, end);
  const bool pair = text.substr(end, 2) == "\r\n";
  text.remove_prefix(std::min(end + (pair ? 2 : 1), text.size()));
  return line;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    words.push_back(word);
  }
  return words;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool is_number(std::string_view text) {
  const std::size_t first = skip_sign(text, 0);
  std::size_t i = skip_digits(text, first);
  std::size_t digits = i - first;
  if (i < text.size() && text[i] == '.') {
    const std::size_t fraction = i + 1;
    i = skip_digits(text, fraction);
    digits += i - fraction;
  }
  if (digits == 0) return false;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    const std::size_t exponent = skip_sign(text, i + 1);
    i = skip_digits(text, exponent);
    if (i == exponent || i - exponent > 6) return false;
  }
  return i == text.size();
}

double number_of(std::string_view number) {
  if (number.starts_with('+')) number.remove_prefix(1);
  double value = 0;
  const auto end = std::from_chars(number.data(), number.data() + number.size(), value);
  if (end.ec != std::errc::result_out_of_range) return value;
  if (number.find("e-") != number.npos || number.find("E-") != number.npos) return 0;
  return number.starts_with('-') ? -HUGE_VAL : HUGE_VAL;
}

ObjLines::int_type ObjLines::underflow() {
  if (!next_line()) return traits_type::eof();
  check_line();
  current_ += '\n';
  setg(current_.data(), current_.data(), current_.data() + current_.size());
  return traits_type::to_int_type(current_[0]);
}

bool ObjLines::next_line() {
  if (text_.empty()) return false;
  current_.clear();
  line_ = next_line_;
  LineKind kind = LineKind::kNone;
  for (bool more = true; more && !text_.empty();) {
    const std::string_view part = take_line(text_);
    ++next_line_;
    if (kind == LineKind::kNone) kind = kind_of(part);
    current_ += part;
    more = goes_on(kind, part);
    if (more) current_.back() = ' ';
  }
  // The parser treats lines as C strings, and only spaces and tabs as blanks: any other blank would
  // add a corner to a face.
  std::replace_if(
      current_.begin(), current_.end(), [](char c) { return c == '\0' || c == '\v' || c == '\f'; },
      ' ');
  return true;
}

void ObjLines::check_line() {
  std::string_view rest = current_;
  const std::string_view keyword = take_word(rest);
  if (has_numbers(keyword)) {
    const bool face = keyword == "f";
    const std::size_t least = keyword == "vt" ? 1 : 3;
    const std::size_t comment = current_.find('#');
    if (comment != current_.npos) {
      current_.resize(comment);
      rest = current_;
      take_word(rest);
    }
    return face ? check_face(rest) : check_numbers(rest, least);
  }
  if (keyword == "mtllib") {
    libraries_.emplace_back(trim(rest));
    current_.clear();
  } else if (keyword == "l" || keyword == "p") {
    lines_or_points_ = true;
  } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf") {
    curves_ = true;
  } else if (keyword == "g" && trim(rest).empty()) {
    current_ = "g default";
  }
}

void ObjLines::check_numbers(std::string_view rest, std::size_t least) {
  std::size_t count = 0;
  std::array<std::string_view, 6> words;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
    if (!is_number(word)) refuse(quoted(word) + " is not a finite number", place());
    if (count < words.size()) words[count] = word;
    ++count;
  }
  color_.reset();
  if (count == words.size()) color_ = {value_of(words[3]), value_of(words[4]), value_of(words[5])};
  if (count < least) {
    refuse(
        "has " + std::to_string(count) + " numbers where " + std::to_string(least) + " are needed",
        place());
  }
}

void ObjLines::check_face(std::string_view rest) {
  std::size_t count = 0;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
    switch (check_reference(word)) {
      case Reference::kRight:
        break;
      case Reference::kMalformed:
        refuse(quoted(word) + " is not a vertex reference", place());
      case Reference::kZero:
        refuse(quoted(word) + " has the index 0; they begin at 1", place());
      case Reference::kTooLarge:
        refuse(quoted(word) + " is out of range", place());
    }
    ++count;
  }
  if (count < 3) {
    short_faces_ = true;
    current_.clear();
  }
  // After "7/" or "7/2/" the parser would read the next reference as the missing one.
  for (std::size_t i = current_.size(); i-- > 0;) {
    if (current_[i] == '/' && (i + 1 == current_.size() || is_blank(current_[i + 1])))
      current_[i] = ' ';
  }
}

}  // namespace raysheaf::io
