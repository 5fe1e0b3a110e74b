#include "io/data_uri.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "io/gltf_rules.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

/// Between "data:" and the comma, in lower case: the kind, parameters, and how it is written.
std::string head_of(std::string_view uri) {
  std::string head(uri.substr(5, uri.find(',') - 5));
  for (char& c : head) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return head;
}
bool is_base64(std::string_view head) {
  return head.ends_with(";base64");
}

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

std::size_t buffer_uri_bytes(std::string_view uri, const std::string& place) {
  constexpr std::array<std::string_view, 7> kKinds = {"application/octet-stream",
                                                      "application/gltf-buffer",
                                                      "image/jpeg",
                                                      "image/png",
                                                      "image/bmp",
                                                      "image/gif",
                                                      "text/plain"};
  const std::string head = head_of(uri);
  const std::string_view kind = std::string_view(head).substr(0, head.find(';'));
  if (!is_base64(head) || std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end()) {
    refuse("is a data URI of a kind that is not read: \"" + printable(head) + "\"", place,
           ErrorCode::kUnsupported);
  }
  return decoded_bytes(base64_digits(uri).size());
}

std::optional<Bytes> decode_data_uri(std::string_view uri) {
  static constexpr auto kValues = digit_values();
  if (!is_base64(head_of(uri))) return std::nullopt;
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
