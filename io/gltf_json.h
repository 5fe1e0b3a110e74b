// Checks of a glTF file that come before anything trusts it.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "io/file.h"

namespace raysheaf::io {

/// The parts of a glTF file, as views into its bytes.
struct GltfParts {
  std::span<const std::uint8_t> json;
  std::span<const std::uint8_t> binary;  ///< the GLB's BIN chunk; empty where there is none
  bool is_glb = false;
};

/// Takes a .glb or .gltf apart (a file that begins with "glTF" is a GLB, whatever its name). Throws
/// where the header, a chunk or the declared length does not fit the file.
[[nodiscard]] GltfParts split_gltf(std::span<const std::uint8_t> file);

/// What the checks learn on the way.
struct GltfFacts {
  std::map<std::string, std::size_t> buffer_files;  ///< external buffers: path and byteLength
  std::vector<std::string> warnings;                ///< extensions that are left out
};

/// Checks the JSON: nesting, types, ranges and indices of every field that is read; versions and
/// required extensions; names of external files; that buffer views lie in their buffers and
/// accessors in their buffer views. Throws `Error` whose place is the field: `accessors[3].count`.
[[nodiscard]] GltfFacts check_gltf_json(const GltfParts& parts, const SceneFile& from);

/// Elements of accessors which no bytes of the file stand for (sparse ones without a buffer view).
inline constexpr std::size_t kMaxUnbackedElements = std::size_t{1} << 18;

}  // namespace raysheaf::io
