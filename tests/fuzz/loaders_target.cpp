// Scene files and images with arbitrary bytes.
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

/// A folder that does not exist, so that files that a scene names are missing.
constexpr const char* kNowhere = "/nonexistent/";

/// A loaded scene must keep the promises of `load_scene`; otherwise there must be an `Error` with a
/// reason. Other exceptions are those that `load_scene` converts to one.
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

/// A folder for this process and one target, which is removed at the end.
class ProcessFolder {
 public:
  explicit ProcessFolder(const std::string& target)
      : path_(std::filesystem::temp_directory_path() /
              ("raysheaf-fuzz-" + target + "-" + std::to_string(getpid()))) {
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

void run_draco(Input input) {
  if (input.size() < 5) return;
  const auto number = [&](std::size_t i) { return input[i] + 256u * input[i + 1]; };
  const Input packed = input.subspan(4);
  std::string json =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(packed.size()) +
      R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(packed.size()) +
      R"(}],"accessors":[{"componentType":5126,"type":"VEC3","count":)" +
      std::to_string(number(0) + 1) + R"(},{"componentType":5125,"type":"SCALAR","count":)" +
      std::to_string(3 * number(2) + 3) +
      R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,)"
      R"("extensions":{"KHR_draco_mesh_compression":{"bufferView":0,)"
      R"("attributes":{"POSITION":0}}}}]}],"nodes":[{"mesh":0}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  io::Bytes glb;
  const auto put = [&](std::size_t value) {
    for (int i = 0; i < 32; i += 8) glb.push_back(static_cast<std::uint8_t>(value >> i));
  };
  put(0x46546c67), put(2), put(28 + json.size() + packed.size());
  put(json.size()), put(0x4e4f534a), glb.insert(glb.end(), json.begin(), json.end());
  put(packed.size()), put(0x004e4942), glb.insert(glb.end(), packed.begin(), packed.end());
  load([&] { return io::load_gltf(glb, {std::string(kNowhere) + "scene.glb"}).scene; });
}

void run_obj(Input input) {
  load([&] { return io::load_obj(bytes_of(input), {std::string(kNowhere) + "scene.obj"}); });
}

void run_ply(Input input) {
  static const ProcessFolder folder("ply");
  const std::string image = (folder.path() / "t.png").string();
  static const bool written = (write_png({"", 1, 1, {1, 2, 3, 255}}, image), true);
  if (!written) return;
  load([&] { return io::load_ply(bytes_of(input), {(folder.path() / "scene.ply").string()}); });
}

void run_stl(Input input) {
  load([&] { return io::load_stl(bytes_of(input), {std::string(kNowhere) + "scene.stl"}); });
}

void run_mtl(Input input) {
  static const ProcessFolder folder("mtl");
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
  // An image that can be decoded must survive being encoded and decoded.
  if (image->rgba.size() > 1u << 16) return;
  const auto again = io::decode_image(encode_png(*image));
  if (!again || again->rgba != image->rgba) std::abort();
}

void run_exr(Input input) {
  static const ProcessFolder folder("exr");
  const std::string file = (folder.path() / "t.exr").string();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(input.data()), std::ssize(input));
  static constexpr std::string_view kScene =
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
  static const bool written = [] {
    std::ofstream(folder.path() / "a.mtl") << "newmtl a\nmap_Kd t.exr\nnorm t.exr\n";
    return true;
  }();
  if (!written) return;
  load([&] {
    return io::load_obj({kScene.begin(), kScene.end()}, {(folder.path() / "a.obj").string()});
  });
  load([&] {
    SceneDescription scene;
    scene.environment = load_environment(file);
    return scene;
  });
}

void run_hdr(Input input) {
  try {
    const Environment map = io::decode_radiance_hdr(input, "fuzz.hdr");
    bool good = map.radiance.size() == std::size_t{map.width} * map.height && !map.empty();
    for (const Vec3& v : map.radiance) {
      for (const float x : {v.x, v.y, v.z}) good = good && x >= 0;
    }
    if (!good) std::abort();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kInternal || error.sentence().empty()) std::abort();
  }
}

}  // namespace raysheaf::fuzz
