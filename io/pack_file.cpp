#include "raysheaf/block_file.h"

#include "io/file.h"
#include "io/gltf.h"
#include "io/outer_cut.h"
#include "io/ply.h"
#include "io/refuse.h"
#include "io/stl.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

std::optional<io::OuterScene> read_outer(const std::string& path, const PackOptions& options) {
  if (!io::file_exists(path)) return std::nullopt;
  const std::string ending = io::ending_of(path);
  try {
    if (ending == "gltf" || ending == "glb") return io::read_outer_gltf(path, options);
    if (ending == "ply") return io::read_outer_ply(path, options);
    if (ending == "stl") return io::read_outer_stl(path, options);
  } catch (const io::NeedsWholeFile&) {
  }
  return std::nullopt;
}

}  // namespace

std::optional<SceneDescription> pack_file(const std::string& path, BlockSink* sink,
                                          const PackOptions& options) {
  if (options.triangles_a_block < 1 || options.triangles_a_block > kBlockTriangles)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from 1 to " + std::to_string(kBlockTriangles) + ", not " +
                    std::to_string(options.triangles_a_block),
                "triangles_a_block");
  auto scene = io::naming(path, [&] {
    auto read = read_outer(path, options);
    if (read) validate_but_triangles(read->rest);
    return read;
  });
  if (!scene) return std::nullopt;
  return io::within_memory(path, [&] { return io::cut_outer(std::move(*scene), sink, options); });
}

}  // namespace raysheaf
