// Caches images that several files of a sequence refer to.
#pragma once

#include <map>
#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Decoded images by path; one without pixels could not be decoded.
using ImageCache = std::map<std::string, Image>;

}  // namespace raysheaf::io
