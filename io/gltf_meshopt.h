// Decompresses buffer views with EXT_meshopt_compression (A. Kapoulkine), as gltfpack and others
// write it, and with its successor KHR_meshopt_compression, as far as the build's meshoptimizer
// supports it.
#pragma once

#include <span>
#include <string>

#include "io/file.h"
#include "io/json_value.h"

namespace raysheaf::io {

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kKhrMeshopt = "KHR_meshopt_compression";

/// Whether this build decompresses meshopt. If not, the views' uncompressed buffers are used.
[[nodiscard]] bool unpacks_meshopt();

/// The compression extension of a view, with its name. `json` is null if the view has none or this
/// build cannot decompress it.
struct MeshoptPacking {
  const JsonValue* json = nullptr;
  const char* name = kMeshopt;
};
[[nodiscard]] MeshoptPacking meshopt_packing(const JsonValue& view);

/// Checks a compressed view: its bytes lie within their buffer, they decompress to the view's
/// length, and that length is possible for so many bytes. Throws `Error`.
void check_meshopt(const JsonValue& root, const JsonValue& view, const std::string& place);

/// The decompressed bytes of a checked view. Throws `Error` if `packed` is damaged or has a version
/// that this build's meshoptimizer does not read.
[[nodiscard]] Bytes unpack_meshopt(const MeshoptPacking& packing,
                                   std::span<const std::uint8_t> packed, const std::string& place);

}  // namespace raysheaf::io
