#include "io/text_lines.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "io/refuse.h"

namespace raysheaf::io {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0';
}

/// A loop by hand: `find_first_of` calls a function for each character.
std::size_t line_size(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size() && text[i] != '\n' && text[i] != '\r') ++i;
  return i;
}

/// The value of a number that double cannot represent: 0 if it is too small.
double value_out_of_range(std::string_view number) {
  const std::size_t exponent = number.find_first_of("eE");
  const bool is_small = exponent == number.npos
                            ? number.find_first_of("123456789") > number.find('.')
                            : number.find('-', exponent) != number.npos;
  if (is_small) return 0;
  return number.starts_with('-') ? -HUGE_VAL : HUGE_VAL;
}

std::optional<double> plain_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
  return error == std::errc::result_out_of_range ? value_out_of_range(word) : value;
}

/// "1.#IND", "-1.#QNAN0" and "1.#INF", as Microsoft's C library wrote them.
std::optional<double> microsoft_number(std::string_view word) {
  const std::size_t mark = word.find(".#");
  if (mark == word.npos) return std::nullopt;
  const std::string kind = in_lower_case(word.substr(mark + 2));
  if (kind.starts_with("inf")) return word.starts_with('-') ? -HUGE_VAL : HUGE_VAL;
  const bool is_nan =
      kind.starts_with("ind") || kind.starts_with("qnan") || kind.starts_with("snan");
  return is_nan ? std::optional(std::numeric_limits<double>::quiet_NaN()) : std::nullopt;
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

std::string in_lower_case(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string_view without_comment(std::string_view line) {
  std::size_t mark = line.find('#');
  while (mark != line.npos && mark > 0 && line[mark - 1] == '.') mark = line.find('#', mark + 1);
  return line.substr(0, mark);
}

std::optional<double> read_number(std::string_view word, bool* comma) {
  if (const auto number = plain_number(word)) return number;
  const std::size_t at = word.find(',');
  if (at == word.npos) return microsoft_number(word);
  std::string pointed(word);
  if (at + 1 == word.size())
    pointed.pop_back();
  else
    pointed[at] = '.';
  const auto number = plain_number(pointed);
  *comma = *comma || number;
  return number;
}

std::string in_quotes(std::string_view word) {
  return "\"" + printable(std::string(word)) + "\"";
}

}  // namespace raysheaf::io
