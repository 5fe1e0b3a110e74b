// Bytes that stand in a URI: data:image/png;base64,... (RFC 2397, RFC 4648).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "io/file.h"

namespace raysheaf::io {

[[nodiscard]] inline bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}

/// How many bytes a buffer's URI stands for. Throws `Error` (kUnsupported) where it is of a kind
/// that is not read for buffers.
[[nodiscard]] std::size_t buffer_uri_bytes(std::string_view uri, const std::string& place);

/// The bytes, of whatever kind; nothing where they are not in base 64, or with a wrong digit.
[[nodiscard]] std::optional<Bytes> decode_data_uri(std::string_view uri);

}  // namespace raysheaf::io
