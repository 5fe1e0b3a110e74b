// Data URIs (RFC 2397): data:image/png;base64,... (RFC 4648) or data:,...
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/file.h"

namespace raysheaf::io {

/// The scheme may be in capitals (RFC 3986).
[[nodiscard]] bool is_data_uri(std::string_view uri);

/// The bytes of a data URI of any media type. Nothing if the comma is missing, a character is not a
/// base64 digit, or a "%" begins no escape sequence.
[[nodiscard]] std::optional<Bytes> decode_data_uri(std::string_view uri);

}  // namespace raysheaf::io
