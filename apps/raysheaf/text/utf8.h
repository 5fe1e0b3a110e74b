// Text that is UTF-8, whatever bytes a name has.
#pragma once

#include <string>
#include <string_view>

namespace raysheaf::app {

/// The text, with U+FFFD for each byte that is not part of UTF-8 (RFC 3629).
[[nodiscard]] std::string valid_utf8(std::string_view text);

}  // namespace raysheaf::app
