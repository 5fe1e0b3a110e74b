// Rewrites MTL text where the parser would silently misread it.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace raysheaf::io {

/// Returns the same materials, one statement per line. Colours have three linear components:
/// missing ones equal the first, and CIE XYZ is converted. Options of maps have all their numbers.
/// Materials without an illumination model get model 2, and those without Kd are black. `warn` is
/// called for each ignored feature.
[[nodiscard]] std::string plain_mtl(std::string_view text,
                                    const std::function<void(const std::string&)>& warn);

}  // namespace raysheaf::io
