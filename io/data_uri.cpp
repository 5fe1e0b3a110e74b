#include "io/data_uri.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace raysheaf::io {
namespace {

/// The part between "data:" and the comma, in lower case: media type, parameters and encoding. The
/// media type is optional (RFC 2397) and ignored.
std::string head_of(std::string_view uri) {
  std::string head(uri.substr(5, uri.find(',') - 5));
  for (char& c : head) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return head;
}
bool is_base64(std::string_view head) {
  return head.ends_with(";base64");
}

/// Two digits at the end make one byte, three make two, and a single one makes none.
std::size_t decoded_bytes(std::size_t digits) {
  return digits / 4 * 3 + (digits % 4 == 0 ? 0 : digits % 4 - 1);
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const int lower = c | 0x20;
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

/// Decodes percent-encoding: "%20" becomes the byte 32. Nothing if a "%" is not followed by two
/// hexadecimal digits.
std::optional<Bytes> decode_escaped(std::string_view text) {
  Bytes bytes;
  bytes.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      bytes.push_back(static_cast<std::uint8_t>(text[i]));
      continue;
    }
    if (text.size() - i < 3) return std::nullopt;
    const int high = hex_value(text[i + 1]), low = hex_value(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes.push_back(static_cast<std::uint8_t>(16 * high + low));
    i += 2;
  }
  return bytes;
}

constexpr std::uint8_t kNoDigit = 0xff;

constexpr std::array<std::uint8_t, 256> digit_values() {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::uint8_t, 256> values{};
  values.fill(kNoDigit);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    values[static_cast<std::uint8_t>(kDigits[i])] = static_cast<std::uint8_t>(i);
  return values;
}

/// Nothing if a character is not a base64 digit. Digits may be percent-encoded, as any character of
/// a URI.
std::optional<Bytes> decode_base64(std::string_view text) {
  static constexpr auto kValues = digit_values();
  std::string plain;
  if (text.find('%') != text.npos) {
    const std::optional<Bytes> bytes = decode_escaped(text);
    if (!bytes) return std::nullopt;
    plain.assign(bytes->begin(), bytes->end());
    text = plain;
  }
  while (text.ends_with('=')) text.remove_suffix(1);
  Bytes bytes;
  bytes.reserve(decoded_bytes(text.size()));
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::uint8_t value = kValues[static_cast<std::uint8_t>(text[i])];
    if (value == kNoDigit) return std::nullopt;
    bits = bits << 6 | value;
    // Each digit except the first of four completes a byte.
    if (i % 4 != 0) bytes.push_back(static_cast<std::uint8_t>(bits >> (6 - 2 * (i % 4))));
  }
  return bytes;
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  constexpr std::string_view kScheme = "data:";
  return uri.size() >= kScheme.size() &&
         std::equal(kScheme.begin(), kScheme.end(), uri.begin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

std::optional<Bytes> decode_data_uri(std::string_view uri) {
  if (uri.find(',') == uri.npos) return std::nullopt;
  const std::string_view data = uri.substr(uri.find(',') + 1);
  return is_base64(head_of(uri)) ? decode_base64(data) : decode_escaped(data);
}

}  // namespace raysheaf::io
