// A glTF file as the parser's structs, checked, with its images still encoded.
#pragma once

#include <tiny_gltf.h>

#include <string>
#include <vector>

#include "io/file.h"
#include "io/image.h"

namespace raysheaf::io {

struct GltfModel {
  tinygltf::Model model;
  std::vector<EncodedImage> images;  ///< one for each of `model.images`; no bytes where missing
  std::vector<std::string> warnings;
  std::size_t file_bytes = 0;  ///< of the file and its buffers, for limits in proportion
};

/// Checks and parses. Every index in the result is in range, every accessor within its buffer.
[[nodiscard]] GltfModel parse_gltf(const Bytes& file, const SceneFile& from);

}  // namespace raysheaf::io
