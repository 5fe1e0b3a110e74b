// Bytes that stand in a URI (RFC 2397): data:image/png;base64,... (RFC 4648), or data:,...
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/file.h"

namespace raysheaf::io {

/// Schemes may be in capitals (RFC 3986).
[[nodiscard]] bool is_data_uri(std::string_view uri);

/// The bytes, of whatever kind; nothing where there is no comma, a character is no digit of base
/// 64, or "%" begins no escape.
[[nodiscard]] std::optional<Bytes> decode_data_uri(std::string_view uri);

}  // namespace raysheaf::io
