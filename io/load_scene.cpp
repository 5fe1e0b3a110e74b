// The one door for scene files: looks at the ending, and puts the file's name before what went
// wrong.
#include <new>

#include "io/file.h"
#include "io/gltf.h"
#include "io/obj.h"
#include "io/ply.h"
#include "io/stl.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace {

using Loader = SceneDescription (*)(const io::Bytes&, const io::SceneFile&);

Loader loader_for(const std::string& path) {
  const std::string ending = io::ending_of(path);
  if (ending == "gltf" || ending == "glb") return io::load_gltf;
  if (ending == "obj") return io::load_obj;
  if (ending == "ply") return io::load_ply;
  if (ending == "stl") return io::load_stl;
  throw Error(ErrorCode::kUnsupported, "the ending is none of .gltf, .glb, .obj, .ply and .stl",
              path);
}

SceneDescription load_checked(const std::string& path, const LoadOptions& options) {
  // Before the whole file is read, but not before it is known to be there.
  if (io::file_exists(path)) static_cast<void>(loader_for(path));
  const io::Bytes file = io::read_file(path);
  if (file.empty()) throw Error(ErrorCode::kInvalidData, "the file is empty", path);
  SceneDescription scene = loader_for(path)(file, {path, options.allow_external});
  validate(scene);
  return scene;
}

}  // namespace

SceneDescription load_scene(const std::string& path, const LoadOptions& options) {
  try {
    return load_checked(path, options);
  } catch (const Error& error) {
    const bool named = error.place() == path;
    throw Error(error.code(), error.sentence(),
                named || error.place().empty() ? path : path + ": " + error.place());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory for this scene", path);
  } catch (const std::exception& error) {
    throw Error(ErrorCode::kInvalidData, std::string("cannot be read: ") + error.what(), path);
  }
}

}  // namespace raysheaf
