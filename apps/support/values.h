// Values of options: text in, numbers out. Each throws `Error` (kInvalidArgument) with one
// sentence.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "raysheaf/types.h"

namespace raysheaf::app {

/// "640x480": each side from 1 to 16384.
[[nodiscard]] std::pair<std::uint32_t, std::uint32_t> parse_size(const std::string& text);

/// A whole number from `low` to `high`.
[[nodiscard]] std::uint32_t parse_count(const std::string& text, std::uint32_t low,
                                        std::uint32_t high);

/// A whole number from 0 to 2^64 - 1.
[[nodiscard]] std::uint64_t parse_seed(const std::string& text);

/// A whole number; a K, M or G after it multiplies it by a thousand, a million or a thousand
/// million.
[[nodiscard]] std::uint64_t parse_amount(const std::string& text);

/// The same in powers of 1024, for bytes.
[[nodiscard]] std::uint64_t parse_bytes(const std::string& text);

/// A finite number above zero.
[[nodiscard]] float parse_positive(const std::string& text);

/// A finite number of at least 0, or any finite number.
[[nodiscard]] float parse_not_negative(const std::string& text);
[[nodiscard]] double parse_number(const std::string& text);

/// "X,Y,Z"; finite.
[[nodiscard]] Vec3 parse_point(const std::string& text);

/// "R,G,B", or one number for all three; finite and not negative.
[[nodiscard]] Vec3 parse_color(const std::string& text);

/// "32" or "64".
[[nodiscard]] std::uint32_t parse_key_bits(const std::string& text);

/// "on" or "off".
[[nodiscard]] bool parse_switch(const std::string& text);

/// Whether `path` ends in `ending` (lower case, with its dot), ignoring case.
[[nodiscard]] bool has_ending(std::string_view path, std::string_view ending);

}  // namespace raysheaf::app
