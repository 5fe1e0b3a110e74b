#include "raysheaf/pack.h"

#include "io/file.h"
#include "io/stl.h"
#include "raysheaf/error.h"

namespace raysheaf {

std::optional<SceneDescription> pack_file(const std::string& path, BlockSink* sink,
                                          const PackOptions& options) {
  if (options.triangles_a_block < 1 || options.triangles_a_block > kBlockTriangles)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from 1 to " + std::to_string(kBlockTriangles) + ", not " +
                    std::to_string(options.triangles_a_block),
                "triangles_a_block");
  if (io::ending_of(path) != "stl" || !io::file_exists(path)) return std::nullopt;
  io::OuterStl outer = io::read_outer_stl(path, options);
  if (outer.triangles == nullptr) return std::nullopt;
  return io::cut_outer(std::move(outer.triangles), std::move(outer.scene), sink, options);
}

}  // namespace raysheaf
