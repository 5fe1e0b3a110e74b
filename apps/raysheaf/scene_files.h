// Files that a scene is made of, found without loading it.
#pragma once

#include <string>
#include <vector>

namespace raysheaf::app {

/// What the file of a scene names, as paths from where we are: buffers, images, material libraries
/// and their textures, the files of a sequence. For guards alone: what cannot be read or understood
/// names nothing, and what is named need not exist.
[[nodiscard]] std::vector<std::string> files_named_by(const std::string& scene);

}  // namespace raysheaf::app
