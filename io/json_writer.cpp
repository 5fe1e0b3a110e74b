#include "io/json_writer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace raysheaf::io {
namespace {

/// The length of the UTF-8 character at the start of the text; 0 if it is invalid (RFC 3629,
/// section 4).
std::size_t utf8_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0};
  };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t count = first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (first < 0xc2 || first > 0xf4) return 0;
  // The range of the second byte excludes overlong forms, surrogates and code points above
  // U+10FFFF.
  const std::uint8_t least = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
  const std::uint8_t most = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
  if (byte(1) < least || byte(1) > most) return 0;
  for (std::size_t i = 2; i < count; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  return count;
}

void append_character(std::string_view character, std::string& out) {
  const auto code = static_cast<std::uint8_t>(character[0]);
  if (code == '"' || code == '\\') {
    out += {'\\', character[0]};
  } else if (code < 0x20) {
    constexpr char kDigits[] = "0123456789abcdef";
    out += "\\u00";
    out += {kDigits[code >> 4], kDigits[code & 15]};
  } else {
    out += character;
  }
}

void append_separated(const std::string& text, std::string& out) {
  if (!out.empty()) out += ',';
  out += text;
}

}  // namespace

std::string json_text(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const std::size_t bytes = utf8_bytes(text);
    if (bytes == 0) {
      out += "\xef\xbf\xbd";
    } else {
      append_character(text.substr(0, bytes), out);
    }
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return out += '"';
}

std::string json_number(double number) {
  if (!std::isfinite(number)) return "null";
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.begin(), digits.end(), number).ptr;
  return {digits.begin(), end};
}

void JsonArray::add(const Json& item) {
  append_separated(item.text(), text_);
  ++count_;
}
JsonArray::operator Json() const {
  Json json;
  json.text_ = "[" + text_ + "]";
  return json;
}

void JsonObject::add(std::string_view name, const Json& value) {
  append_separated(json_text(name) + ":" + value.text(), text_);
}
JsonObject::operator Json() const {
  Json json;
  json.text_ = "{" + text_ + "}";
  return json;
}

}  // namespace raysheaf::io
