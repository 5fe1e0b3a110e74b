#include "apps/support/values.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

constexpr std::uint32_t kLargestSide = 16384;

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw Error(ErrorCode::kInvalidArgument, "'" + text + "' " + why);
}

// The whole text as a number, without blanks, plus signs, or the user's locale.
template <typename Number>
std::optional<Number> whole(std::string_view text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return number;
}

// Whether the text is a number that `Number` cannot hold.
template <typename Number>
bool is_beyond(std::string_view text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc::result_out_of_range && stop == end;
}

template <typename Number>
[[noreturn]] void refuse_number(const std::string& text, const std::string& why) {
  refuse(text, is_beyond<Number>(text) ? "is too large or too small for this option" : why);
}

std::uint64_t parse_scaled(const std::string& text, std::uint64_t step) {
  constexpr std::string_view kLetters = "KMG";
  std::string_view digits = text;
  std::uint64_t factor = 1;
  if (!digits.empty()) {
    const auto letter = static_cast<char>(std::toupper(static_cast<unsigned char>(digits.back())));
    const std::size_t place = kLetters.find(letter);
    if (place != std::string_view::npos) {
      digits.remove_suffix(1);
      for (std::size_t i = 0; i <= place; ++i) factor *= step;
    }
  }
  const auto number = whole<std::uint64_t>(digits);
  if (number && *number <= ~std::uint64_t{0} / factor) return *number * factor;
  if (number || is_beyond<std::uint64_t>(digits)) refuse(text, "is too large");
  refuse(text, "is not a whole number, with or without K, M or G after it");
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

}  // namespace

std::pair<std::uint32_t, std::uint32_t> parse_size(const std::string& text) {
  const auto parts = split(text, 'x');
  if (parts.size() == 2) {
    const auto width = whole<std::uint32_t>(parts[0]), height = whole<std::uint32_t>(parts[1]);
    const auto fits = [](std::optional<std::uint32_t> side) {
      return side && *side >= 1 && *side <= kLargestSide;
    };
    if (fits(width) && fits(height)) return {*width, *height};
  }
  refuse(text, "is not WIDTHxHEIGHT with each from 1 to " + std::to_string(kLargestSide) +
                   ", such as 512x512");
}

std::uint32_t parse_count(const std::string& text, std::uint32_t low, std::uint32_t high) {
  const auto number = whole<std::uint32_t>(text);
  if (number && *number >= low && *number <= high) return *number;
  refuse(text, "is not a whole number from " + std::to_string(low) + " to " + std::to_string(high));
}

std::uint64_t parse_seed(const std::string& text) {
  if (const auto number = whole<std::uint64_t>(text)) return *number;
  refuse(text, "is not a whole number from 0 to 18446744073709551615");
}

std::uint64_t parse_amount(const std::string& text) {
  return parse_scaled(text, 1000);
}

std::uint64_t parse_bytes(const std::string& text) {
  return parse_scaled(text, 1024);
}

float parse_positive(const std::string& text) {
  const auto number = whole<float>(text);
  if (number && std::isfinite(*number) && *number > 0) return *number;
  refuse_number<float>(text, "is not a number above 0");
}

float parse_not_negative(const std::string& text) {
  const auto number = whole<float>(text);
  if (number && std::isfinite(*number) && *number >= 0) return *number;
  refuse_number<float>(text, "is not a number, 0 or more");
}

double parse_number(const std::string& text) {
  const auto number = whole<double>(text);
  if (number && std::isfinite(*number)) return *number;
  refuse_number<double>(text, "is not a number");
}

Vec3 parse_point(const std::string& text) {
  const auto parts = split(text, ',');
  std::vector<float> numbers;
  for (const std::string_view part : parts) {
    const auto number = whole<float>(part);
    if (number && std::isfinite(*number)) numbers.push_back(*number);
  }
  if (parts.size() == 3 && numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
  refuse(text, "is not X,Y,Z, three finite numbers such as 1,2,0.5");
}

Vec3 parse_color(const std::string& text) {
  const auto parts = split(text, ',');
  std::vector<float> numbers;
  for (const std::string_view part : parts) {
    const auto number = whole<float>(part);
    if (number && std::isfinite(*number) && *number >= 0) numbers.push_back(*number);
  }
  if (numbers.size() == parts.size()) {
    if (numbers.size() == 1) return {numbers[0], numbers[0], numbers[0]};
    if (numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
  }
  refuse(text, "is neither one number nor R,G,B, each of them 0 or more");
}

std::uint32_t parse_key_bits(const std::string& text) {
  if (text == "32") return 32;
  if (text == "64") return 64;
  refuse(text, "is neither 32 nor 64");
}

bool parse_switch(const std::string& text) {
  if (text != "on" && text != "off") refuse(text, "is neither on nor off");
  return text == "on";
}

bool has_ending(std::string_view path, std::string_view ending) {
  if (path.size() < ending.size()) return false;
  return std::equal(ending.rbegin(), ending.rend(), path.rbegin(), [](char a, char b) {
    return a == std::tolower(static_cast<unsigned char>(b));
  });
}

}  // namespace raysheaf::app
