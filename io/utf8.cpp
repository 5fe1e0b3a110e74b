#include "io/utf8.h"

#include <cstdint>
#include <string_view>

namespace raysheaf::io {
namespace {

/// The length of the UTF-8 character at the start of the text; 0 if it is invalid (Unicode 15,
/// table 3-7).
std::size_t character_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0};
  };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4) return 0;
  // Excludes overlong forms, surrogates and numbers above 0x10ffff.
  const std::uint8_t low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
  const std::uint8_t high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
  if (byte(1) < low || byte(1) > high) return 0;
  for (std::size_t i = 2; i < count; ++i) {
    if (byte(i) < 0x80 || byte(i) > 0xbf) return 0;
  }
  return count;
}

}  // namespace

std::string whole_utf8(const std::string& text) {
  std::string result;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t count = character_bytes(rest);
    result += count > 0 ? rest.substr(0, count) : std::string_view("\xef\xbf\xbd");
    rest.remove_prefix(count > 0 ? count : 1);
  }
  return result;
}

std::string printable(const std::string& text, std::size_t most) {
  std::string result = whole_utf8(text.substr(0, most));
  for (char& c : result) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return result + (text.size() > most ? "..." : "");
}

}  // namespace raysheaf::io
