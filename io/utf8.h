// Text of files as messages may hold it.
#pragma once

#include <cstddef>
#include <string>

namespace raysheaf::io {

/// The text with U+FFFD in place of bytes that are not part of a whole UTF-8 character.
[[nodiscard]] std::string whole_utf8(const std::string& text);

/// A field's path as errors print it: control characters and bytes that are no UTF-8 replaced, long
/// names cut.
[[nodiscard]] std::string printable(const std::string& text, std::size_t most = 64);

}  // namespace raysheaf::io
