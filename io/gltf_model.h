// A glTF file, checked: its JSON, and where the bytes are that it speaks of.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/file.h"
#include "io/image.h"
#include "io/json_value.h"

namespace raysheaf::io {

struct GltfView {
  std::span<const std::uint8_t> bytes;
  std::size_t stride = 0;  ///< 0: elements lie side by side
};

struct GltfSparse {
  std::size_t count = 0;
  int index_type = 0;  ///< a `GltfComponent`, as the one below
  std::span<const std::uint8_t> indices, values;
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
  std::vector<Bytes> buffers;  ///< those that are not part of the file itself
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
/// look into `file`, which must outlive them.
[[nodiscard]] GltfModel parse_gltf(const Bytes& file, const SceneFile& from);

}  // namespace raysheaf::io
