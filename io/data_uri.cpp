#include "io/data_uri.h"

#include <algorithm>
#include <array>

#include "io/gltf_rules.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

/// Behind the comma, without the padding.
std::string_view base64_digits(std::string_view uri) {
  std::string_view digits = uri.substr(std::min(uri.find(','), uri.size() - 1) + 1);
  while (digits.ends_with('=')) digits.remove_suffix(1);
  return digits;
}

/// Of the last digits two make a byte and three make two; one alone makes none.
std::size_t decoded_bytes(std::size_t digits) {
  return digits / 4 * 3 + (digits % 4 == 0 ? 0 : digits % 4 - 1);
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

}  // namespace

std::size_t data_uri_bytes(std::string_view uri, const std::string& place) {
  constexpr std::array<std::string_view, 7> kKinds = {"application/octet-stream",
                                                      "application/gltf-buffer",
                                                      "image/jpeg",
                                                      "image/png",
                                                      "image/bmp",
                                                      "image/gif",
                                                      "text/plain"};
  const std::size_t comma = uri.find(',');
  const std::string head(uri.substr(5, std::min<std::size_t>(comma, 64) - 5));
  const bool known = std::any_of(kKinds.begin(), kKinds.end(), [&](std::string_view kind) {
    return head == std::string(kind) + ";base64";
  });
  if (comma == uri.npos || !known) {
    refuse("is a data URI of a kind that is not read: \"" + printable(head) + "\"", place,
           ErrorCode::kUnsupported);
  }
  return decoded_bytes(base64_digits(uri).size());
}

std::optional<Bytes> decode_data_uri(std::string_view uri) {
  static constexpr auto kValues = digit_values();
  const std::string_view digits = base64_digits(uri);
  Bytes bytes;
  bytes.reserve(decoded_bytes(digits.size()));
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const std::uint8_t value = kValues[static_cast<std::uint8_t>(digits[i])];
    if (value == kNoDigit) return std::nullopt;
    bits = bits << 6 | value;
    // Each digit but the first of four completes a byte.
    if (i % 4 != 0) bytes.push_back(static_cast<std::uint8_t>(bits >> (6 - 2 * (i % 4))));
  }
  return bytes;
}

}  // namespace raysheaf::io
