// A glTF file, checked: its JSON, and where the bytes are that it speaks of.
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
  std::size_t stride = 0;  ///< 0: elements lie side by side
};

struct GltfSparse {
  std::size_t count = 0;
  int index_type = 0;  ///< a `GltfComponent`, as the one below
  GltfBytes indices, values;
};

struct GltfAccessor {
  int view = -1;  ///< -1: all are zero but the sparse ones
  std::size_t offset = 0, count = 0;
  int component_type = 0;
  std::size_t components = 1;  ///< of an element
  bool is_matrix = false;
  bool normalized = false;
  std::optional<GltfSparse> sparse;
};

struct GltfModel {
  JsonDocument json;
  std::vector<Bytes> buffers;                    ///< those that are not part of the file itself
  std::vector<std::unique_ptr<GltfFile>> files;  ///< such that are read in windows
  std::vector<GltfView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<EncodedImage> images;  ///< one for each of the file's; no bytes where missing
  std::vector<std::string> warnings;
  std::size_t file_bytes = 0;  ///< of the file and its buffers, for limits in proportion

  [[nodiscard]] const JsonValue& root() const { return json.root(); }
  /// One of the root's arrays; empty where there is none.
  [[nodiscard]] std::span<const JsonValue> list(const char* name) const {
    return root().items(name);
  }
};

/// Checks and reads. Every index in the result is in range, every accessor within its buffer. Views
/// look into `file`, which must outlive them. Where that is not held, other files are not, either;
/// pictures are. Throws `NeedsWholeFile` then where the JSON has more than 64 MiB.
[[nodiscard]] GltfModel parse_gltf(const GltfBytes& file, const SceneFile& from);

}  // namespace raysheaf::io
