// Scene files and pictures as strangers send them.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "fuzz/targets.h"
#include "io/gltf.h"
#include "io/image.h"
#include "io/obj.h"
#include "io/ply.h"
#include "io/radiance_hdr.h"
#include "io/stl.h"
#include "raysheaf/animation.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::fuzz {
namespace {

/// Nothing lies here, so that files which a scene names are missing.
constexpr const char* kNowhere = "/nonexistent/";

/// A scene that a loader gives is as `load_scene` promises it, or there is an `Error` that says
/// why not. Other exceptions are those that `load_scene` turns into one.
template <class Load>
void load(const Load& load_it) {
  try {
    const SceneDescription scene = load_it();
    validate(scene);
    static_cast<void>(world_bounds(scene));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kInternal && !error.sentence().empty()) return;
    std::fprintf(stderr, "not a sentence for users: %s\n", error.what());
    std::abort();
  }
}

io::Bytes bytes_of(Input input) {
  return {input.begin(), input.end()};
}

/// A folder for this process, gone at its end.
class ProcessFolder {
 public:
  ProcessFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("raysheaf-fuzz-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~ProcessFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ProcessFolder(const ProcessFolder&) = delete;
  ProcessFolder& operator=(const ProcessFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

void run_gltf(Input input) {
  load([&] {
    io::GltfScene gltf = io::load_gltf(bytes_of(input), {std::string(kNowhere) + "scene.gltf"});
    const auto animation = animate(std::move(gltf.scene), std::move(gltf.rig), 1);
    for (std::uint32_t clip = 0; clip < animation->clips().size(); ++clip) {
      animation->play(clip);
      for (const double part : {0.0, 0.37, 1.0})
        static_cast<void>(animation->seek(part * animation->end()));
    }
    return animation->scene();
  });
}

void run_obj(Input input) {
  load([&] { return io::load_obj(bytes_of(input), {std::string(kNowhere) + "scene.obj"}); });
}

void run_ply(Input input) {
  load([&] { return io::load_ply(bytes_of(input), {std::string(kNowhere) + "scene.ply"}); });
}

void run_stl(Input input) {
  load([&] { return io::load_stl(bytes_of(input), {std::string(kNowhere) + "scene.stl"}); });
}

void run_mtl(Input input) {
  static const ProcessFolder folder;
  std::ofstream(folder.path() / "scene.mtl", std::ios::binary)
      .write(reinterpret_cast<const char*>(input.data()), std::ssize(input));
  static constexpr std::string_view kScene =
      "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n";
  load([&] {
    return io::load_obj({kScene.begin(), kScene.end()}, {(folder.path() / "scene.obj").string()});
  });
}

void run_image(Input input) {
  const auto size = io::image_size(input);
  const auto image = io::decode_image(input);
  if (!image) return;
  const bool fits = size && image->width == size->width && image->height == size->height &&
                    image->rgba.size() == std::size_t{4} * image->width * image->height;
  if (!fits) std::abort();
  // What can be read can be written and is then the same.
  if (image->rgba.size() > 1u << 16) return;
  const auto again = io::decode_image(encode_png(*image));
  if (!again || again->rgba != image->rgba) std::abort();
}

void run_hdr(Input input) {
  try {
    const Environment map = io::decode_radiance_hdr(input, "fuzz.hdr");
    bool good = map.radiance.size() == std::size_t{map.width} * map.height && !map.empty();
    for (const Vec3& v : map.radiance) {
      for (const float x : {v.x, v.y, v.z}) good = good && x >= 0 && std::isfinite(x);
    }
    if (!good) std::abort();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kInternal || error.sentence().empty()) std::abort();
  }
}

}  // namespace raysheaf::fuzz
