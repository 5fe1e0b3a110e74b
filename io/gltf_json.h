// Validates a glTF file before other code relies on it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf_bytes.h"
#include "io/json_value.h"

namespace raysheaf::io {

/// The parts of a glTF file, as views into its bytes.
struct GltfParts {
  GltfBytes json;
  GltfBytes binary;  ///< the GLB's BIN chunk; empty if there is none
  bool is_glb = false;
};

/// Splits a .glb or .gltf file into its parts. A file that begins with "glTF" is a GLB, whatever
/// its name. Throws if the header, a chunk or the declared length does not fit the file, and if the
/// file has another format, which the error names. `is_glb`: its extension is .glb.
[[nodiscard]] GltfParts split_gltf(const GltfBytes& file, bool is_glb);

/// Validates the JSON: types, ranges and indices of every field that is read; versions and required
/// extensions; names of external files; and that buffer views lie within their buffers and
/// accessors within their buffer views. Throws `Error` whose place is the field:
/// `accessors[3].count`. Returns warnings about ignored features.
[[nodiscard]] std::vector<std::string> check_gltf_json(const JsonValue& root,
                                                       const GltfParts& parts,
                                                       const SceneFile& from);

/// Whether a buffer has bytes of its own, in a file or in the GLB's chunk. Other buffers are
/// placeholders for decompressed views, or unused.
[[nodiscard]] bool has_bytes(const JsonValue& buffer, std::size_t index, const GltfParts& parts);

/// glTF's codes of component types.
enum GltfComponent : int {
  kGltfByte = 5120,
  kGltfUnsignedByte = 5121,
  kGltfShort = 5122,
  kGltfUnsignedShort = 5123,
  kGltfUnsignedInt = 5125,
  kGltfFloat = 5126,
};
/// 0 if there is no such type.
[[nodiscard]] std::size_t component_bytes(int type);
/// Components per element: "VEC3" has three. 0 if there is no such type.
[[nodiscard]] std::size_t component_count(std::string_view type);

/// An object's extension, or nullptr.
[[nodiscard]] const JsonValue* extension(const JsonValue& object, const char* name);
/// The lights of KHR_lights_punctual.
[[nodiscard]] std::span<const JsonValue> gltf_lights(const JsonValue& root);

/// The most elements of accessors without bytes in the file (sparse accessors without a buffer
/// view).
inline constexpr std::size_t kMaxUnbackedElements = std::size_t{1} << 18;

}  // namespace raysheaf::io
