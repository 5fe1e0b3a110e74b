// Primitives that are packed: KHR_draco_mesh_compression (Khronos 2018), as Blender and others
// write it. Unpacked by Draco, where the build has it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "io/file.h"
#include "io/gltf_model.h"
#include "io/json_value.h"

namespace raysheaf::io {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// Whether this build unpacks them. Where it does not, they are what their accessors say.
[[nodiscard]] bool unpacks_draco();

/// What packs a primitive; nullptr where nothing does, or this build cannot unpack it.
[[nodiscard]] const JsonValue* draco_packing(const JsonValue& primitive);

/// Checks how primitives are packed: into triangles, each accessor by one of them, and no more
/// elements than so many bytes can hold. Gives which accessors they fill; what those say of buffer
/// views does not count. Throws `Error`.
[[nodiscard]] std::vector<bool> check_draco(const JsonValue& root);

/// The values of an accessor, side by side.
struct DracoValues {
  std::size_t accessor = 0;
  Bytes bytes;
};

/// What a primitive that was checked fills, its indices first. Throws `Error` where `packed` is
/// damaged, or holds anything else than the accessors say.
[[nodiscard]] std::vector<DracoValues> unpack_draco(const JsonValue& primitive,
                                                    std::span<const GltfAccessor> accessors,
                                                    std::span<const std::uint8_t> packed,
                                                    const std::string& place);

}  // namespace raysheaf::io
