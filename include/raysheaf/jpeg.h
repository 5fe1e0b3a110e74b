// JPEG files out; all else that is written is in raysheaf/io.h.
#pragma once

#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Writes an eight-bit image as JPEG of quality 92, as carefully as `write_png` writes; alpha is
/// left out.
void write_jpeg(const Image& image, const std::string& path);

}  // namespace raysheaf
