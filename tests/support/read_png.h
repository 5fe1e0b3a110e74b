// Pictures back from files.
#pragma once

#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf::test {

/// PNG or JPEG. Throws std::runtime_error where the file is not a picture.
Image read_png(const std::string& path);

}  // namespace raysheaf::test
