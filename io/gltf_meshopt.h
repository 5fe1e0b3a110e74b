// Buffer views that are packed: EXT_meshopt_compression (A. Kapoulkine), as gltfpack and others
// write it. Unpacked by meshoptimizer, where the build has it.
#pragma once

#include <span>
#include <string>

#include "io/file.h"
#include "io/json_value.h"

namespace raysheaf::io {

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";

/// Whether this build unpacks them. Where it does not, they are as their own buffers have them.
[[nodiscard]] bool unpacks_meshopt();

/// What packs a view; nullptr where nothing does, or this build cannot unpack it.
[[nodiscard]] const JsonValue* meshopt_packing(const JsonValue& view);

/// Checks a view's packing: its bytes lie in their buffer, what they unpack to is the view's
/// length, and no more than so many bytes can hold. Throws `Error`.
void check_meshopt(const JsonValue& root, const JsonValue& view, const std::string& place);

/// The bytes of a view that was checked. Throws `Error` where `packed` is damaged.
[[nodiscard]] Bytes unpack_meshopt(const JsonValue& packing, std::span<const std::uint8_t> packed,
                                   const std::string& place);

}  // namespace raysheaf::io
