// Reads images from files.
#pragma once

#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf::test {

/// PNG or JPEG. Throws std::runtime_error if the file is not an image.
Image read_png(const std::string& path);

}  // namespace raysheaf::test
