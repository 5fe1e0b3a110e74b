// Lines, words and numbers of text formats.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf::io {

inline constexpr const char* kCommaRemark = "Commas in numbers are read as decimal points.";

/// A file's text without the UTF-8 byte order mark. Throws `Error` (kUnsupported) for UTF-16.
[[nodiscard]] std::string_view text_of(std::span<const std::uint8_t> file);
/// Removes the first line and its end ("\n", "\r" or "\r\n") from `text`, which must not be empty.
[[nodiscard]] std::string_view take_line(std::string_view& text);
/// Removes the first word from a line. Zero bytes are blanks.
std::string_view take_word(std::string_view& text);
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text);
[[nodiscard]] std::string_view trim(std::string_view text);
[[nodiscard]] std::string in_lower_case(std::string_view word);
/// The line without its comment. A '#' begins one, except in a number like "1.#IND".
[[nodiscard]] std::string_view without_comment(std::string_view line);

/// The number that a word stands for, or nothing. Apart from "-1.5e3", it reads what programs
/// write: "nan", "inf", "-nan(ind)" and "1.#INF"; and numbers with one comma, which is the decimal
/// point or stands at the end: then it sets `*comma`. Beyond the range of double, the number is 0
/// or infinite.
[[nodiscard]] std::optional<double> read_number(std::string_view word, bool* comma);

/// The word in double quotes, for error messages.
[[nodiscard]] std::string in_quotes(std::string_view word);

}  // namespace raysheaf::io
