// Buffer views that are packed: EXT_meshopt_compression (A. Kapoulkine), as gltfpack and others
// write it, and its successor KHR_meshopt_compression, as far as the build's meshoptimizer goes.
#pragma once

#include <span>
#include <string>

#include "io/file.h"
#include "io/json_value.h"

namespace raysheaf::io {

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kKhrMeshopt = "KHR_meshopt_compression";

/// Whether this build unpacks them. Where it does not, they are as their own buffers have them.
[[nodiscard]] bool unpacks_meshopt();

/// What packs a view, by the name of its extension; `json` is null where nothing does, or this
/// build cannot unpack it.
struct MeshoptPacking {
  const JsonValue* json = nullptr;
  const char* name = kMeshopt;
};
[[nodiscard]] MeshoptPacking meshopt_packing(const JsonValue& view);

/// Checks a view's packing: its bytes lie in their buffer, what they unpack to is the view's
/// length, and no more than so many bytes can hold. Throws `Error`.
void check_meshopt(const JsonValue& root, const JsonValue& view, const std::string& place);

/// The bytes of a view that was checked. Throws `Error` where `packed` is damaged, or of a version
/// that this build's meshoptimizer does not read.
[[nodiscard]] Bytes unpack_meshopt(const MeshoptPacking& packing,
                                   std::span<const std::uint8_t> packed, const std::string& place);

}  // namespace raysheaf::io
