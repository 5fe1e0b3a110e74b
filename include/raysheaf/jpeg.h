// Writing JPEG files. raysheaf/io.h writes all other formats.
#pragma once

#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Writes an eight-bit image as JPEG of quality 92, to a temporary file that is then renamed; omits
/// alpha.
void write_jpeg(const Image& image, const std::string& path);

}  // namespace raysheaf
