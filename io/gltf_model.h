// A validated glTF file: its JSON, and the places of the bytes that it refers to.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/gltf_bytes.h"
#include "io/image.h"
#include "io/json_value.h"

namespace raysheaf::io {

struct GltfView {
  GltfBytes bytes;
  std::size_t stride = 0;  ///< 0: elements are tightly packed
};

struct GltfSparse {
  std::size_t count = 0;
  int index_type = 0;  ///< a `GltfComponent`, as is `component_type`
  GltfBytes indices, values;
};

struct GltfAccessor {
  int view = -1;  ///< -1: all values are zero except the sparse ones
  std::size_t offset = 0, count = 0;
  int component_type = 0;
  std::size_t components = 1;  ///< per element
  bool is_matrix = false;
  bool normalized = false;
  std::optional<GltfSparse> sparse;
};

struct GltfModel {
  JsonDocument json;
  std::vector<Bytes> buffers;                    ///< buffers that are not part of the file itself
  std::vector<std::unique_ptr<GltfFile>> files;  ///< files that are read in windows
  std::vector<GltfView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<EncodedImage> images;  ///< one per image of the file; without bytes if missing
  std::vector<std::string> warnings;
  std::size_t file_bytes = 0;  ///< of the file and its buffers, for limits in proportion

  [[nodiscard]] const JsonValue& root() const { return json.root(); }
  /// An array of the root object; empty if there is none.
  [[nodiscard]] std::span<const JsonValue> list(const char* name) const {
    return root().items(name);
  }
};

/// Validates and reads a file. All indices in the result are in range, and all accessors lie within
/// their buffers. Views refer to `file`, which must outlive them. If `file` is not held in memory,
/// neither are its external buffers; images are. In that case, throws `NeedsWholeFile` for more
/// than 64 MiB of JSON.
[[nodiscard]] GltfModel parse_gltf(const GltfBytes& file, const SceneFile& from);

}  // namespace raysheaf::io
