// Decompresses primitives with KHR_draco_mesh_compression (Khronos 2018), as Blender and others
// write it, if the build has Draco.
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

/// Whether this build decompresses Draco. If not, the uncompressed accessors are used.
[[nodiscard]] bool unpacks_draco();

/// The compression extension of a primitive; nullptr if it has none or this build cannot decompress
/// it.
[[nodiscard]] const JsonValue* draco_packing(const JsonValue& primitive);

/// Checks compressed primitives: each must hold triangles, each accessor may belong to only one of
/// them, and its counts must not exceed what its bytes can hold. Returns which accessors are filled
/// by decompression; their buffer views are ignored. Throws `Error`.
[[nodiscard]] std::vector<bool> check_draco(const JsonValue& root);

/// The values of an accessor, tightly packed.
struct DracoValues {
  std::size_t accessor = 0;
  Bytes bytes;
};

/// Decompresses a checked primitive and returns its accessors' values, indices first. Throws
/// `Error` if `packed` is damaged or contradicts the accessors.
[[nodiscard]] std::vector<DracoValues> unpack_draco(const JsonValue& primitive,
                                                    std::span<const GltfAccessor> accessors,
                                                    std::span<const std::uint8_t> packed,
                                                    const std::string& place);

}  // namespace raysheaf::io
