// Pictures that several files of a sequence name are read and decoded once.
#pragma once

#include <map>
#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// By path; one without pixels could not be decoded.
using ImageCache = std::map<std::string, Image>;

}  // namespace raysheaf::io
