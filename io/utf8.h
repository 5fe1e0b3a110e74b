// Makes text from files safe for messages.
#pragma once

#include <cstddef>
#include <string>

namespace raysheaf::io {

/// The text with U+FFFD in place of bytes that are not part of a complete UTF-8 character.
[[nodiscard]] std::string whole_utf8(const std::string& text);

/// A field's path for error messages: control characters and invalid UTF-8 are replaced, long names
/// are truncated.
[[nodiscard]] std::string printable(const std::string& text, std::size_t most = 64);

}  // namespace raysheaf::io
