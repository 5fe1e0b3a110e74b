// MTL text as the parser takes it: what it would read wrongly without a word is written so that it
// reads it rightly.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace raysheaf::io {

/// The same materials, a line each. Colours have three linear parts: those left out are as the
/// first, CIE XYZ is converted. Options of maps have all of their numbers. What names no model of
/// illumination has the second, and what names no Kd is black. `warn` is called with a sentence for
/// what is left out.
[[nodiscard]] std::string plain_mtl(std::string_view text,
                                    const std::function<void(const std::string&)>& warn);

}  // namespace raysheaf::io
