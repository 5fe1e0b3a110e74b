// The image of a frame as a file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "raysheaf/backdrop.h"
#include "raysheaf/render.h"

namespace raysheaf::app {

/// sRGB and alpha.
using Rgba = std::array<std::uint8_t, 4>;

/// The image for display.
[[nodiscard]] Image shown_picture(const RenderResult& result,
                                  const std::optional<Backdrop>& backdrop);

/// The name that stands for an image on standard output.
inline constexpr const char* kStandardOutput = "-";

/// Writes PNG and JPEG (tone-mapped) or OpenEXR (linear, with layers, without the backdrop), by the
/// ending of `name`, or PNG to standard output.
void write_picture(const RenderResult& result, const std::string& name, const std::string& path,
                   const std::optional<Backdrop>& backdrop);

}  // namespace raysheaf::app
