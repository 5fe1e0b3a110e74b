// Checks of a glTF file that come before anything trusts it.
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
  GltfBytes binary;  ///< the GLB's BIN chunk; empty where there is none
  bool is_glb = false;
};

/// Takes a .glb or .gltf apart (a file that begins with "glTF" is a GLB, whatever its name). Throws
/// where the header, a chunk or the declared length does not fit the file, and where it is a file
/// of another kind, which the error names. `is_glb`: it is called so.
[[nodiscard]] GltfParts split_gltf(const GltfBytes& file, bool is_glb);

/// Checks the JSON: types, ranges and indices of every field that is read; versions and required
/// extensions; names of external files; that buffer views lie in their buffers and accessors in
/// their buffer views. Throws `Error` whose place is the field: `accessors[3].count`. Gives
/// sentences about what is left out.
[[nodiscard]] std::vector<std::string> check_gltf_json(const JsonValue& root,
                                                       const GltfParts& parts,
                                                       const SceneFile& from);

/// Whether a buffer has bytes of its own, in a file or in the GLB's chunk. Others stand for what
/// packed views of them unpack to, or for nothing.
[[nodiscard]] bool has_bytes(const JsonValue& buffer, std::size_t index, const GltfParts& parts);

/// glTF's numbers for the types of components.
enum GltfComponent : int {
  kGltfByte = 5120,
  kGltfUnsignedByte = 5121,
  kGltfShort = 5122,
  kGltfUnsignedShort = 5123,
  kGltfUnsignedInt = 5125,
  kGltfFloat = 5126,
};
/// 0 where there is no such type.
[[nodiscard]] std::size_t component_bytes(int type);
/// Of an element: "VEC3" has three. 0 where there is no such type.
[[nodiscard]] std::size_t component_count(std::string_view type);

/// An object's extension, or nullptr.
[[nodiscard]] const JsonValue* extension(const JsonValue& object, const char* name);
/// Of KHR_lights_punctual.
[[nodiscard]] std::span<const JsonValue> gltf_lights(const JsonValue& root);

/// Elements of accessors which no bytes of the file stand for (sparse ones without a buffer view).
inline constexpr std::size_t kMaxUnbackedElements = std::size_t{1} << 18;

}  // namespace raysheaf::io
