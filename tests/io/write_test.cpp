// Written files read back the same; failed writes leave nothing behind.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <array>
#include <cmath>
#include <csignal>
#include <limits>
#include <memory>
#include <random>

#include "io/file.h"
#include "io/image.h"
#include "tests/io/io_support.h"
#include "tests/support/scenes.h"

namespace raysheaf::test {
namespace {

using enum ErrorCode;
using Write = IoTest;

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

Mesh random_mesh(std::mt19937& random, std::uint32_t materials) {
  std::uniform_real_distribution<float> anywhere(-100, 100);
  Mesh mesh;
  mesh.name = "mesh \"" + std::to_string(random() % 100) + "\"";
  const auto count = static_cast<std::uint32_t>(3 + random() % 40);
  for (std::uint32_t v = 0; v < count; ++v) {
    mesh.positions.push_back({anywhere(random), anywhere(random) * 1e-30f, anywhere(random)});
    const Vec3 n = {anywhere(random), anywhere(random), anywhere(random)};
    const float l = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    mesh.normals.push_back({n.x / l, n.y / l, n.z / l});
    mesh.uvs.push_back({anywhere(random), anywhere(random)});
    mesh.colors.push_back({std::fabs(n.x / l), 1, std::fabs(n.y / l)});
  }
  if (random() % 2 == 0) mesh.normals.clear();
  if (random() % 2 == 0) mesh.uvs.clear();
  if (random() % 2 == 0) mesh.colors.clear();
  const std::size_t triangles = 1 + random() % 60;
  for (std::size_t t = 0; t < triangles; ++t) {
    mesh.triangles.push_back({static_cast<std::uint32_t>(random() % count),
                              static_cast<std::uint32_t>(random() % count),
                              static_cast<std::uint32_t>(random() % count)});
    const std::uint32_t material = static_cast<std::uint32_t>(random() % (materials + 1));
    mesh.materials.push_back(material == materials ? kInvalidId : material);
  }
  if (random() % 3 == 0) mesh.materials.resize(random() % 2);
  return mesh;
}

SceneDescription random_scene(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  SceneDescription scene;
  scene.images.push_back({"image", 3, 2, {}});
  for (int i = 0; i < 24; ++i) {
    scene.images[0].rgba.push_back(static_cast<std::uint8_t>(i % 4 == 3 ? 255 : random() % 256));
  }
  scene.images.push_back({"see-through", 1, 1, {1, 2, 3, 4}});
  scene.textures.push_back({0, Wrap::kClampToEdge, Wrap::kRepeat, Filter::kNearest});
  scene.textures.push_back({1, Wrap::kMirroredRepeat, Wrap::kRepeat, Filter::kLinear});
  for (int m = 0; m < 3; ++m) {
    Material material;
    material.name = "material " + std::to_string(m);
    material.base_color = {unit(random), unit(random), unit(random), unit(random)};
    material.base_color_texture = {0, {0.5f, unit(random)}, {2, 3}, unit(random)};
    material.metallic_roughness_texture.texture = 1;
    material.emission_texture.texture = m == 0 ? kInvalidId : 1;
    if (m != 1) material.normal_texture = {1, {0.5f, 0}, {1, 2}, 0};
    if (m == 2) material.normal_scale = 0.25f;
    if (m == 2) material.alpha_cutoff = 0.75f;
    if (m == 0) material.alpha_cutoff = 0.5f, material.alpha_blend = true;
    material.metallic = unit(random), material.roughness = unit(random);
    material.emission = {1000 * unit(random), unit(random), 0};
    material.specular = unit(random), material.specular_color = {1, unit(random), 0};
    material.transmission = unit(random), material.ior = 1 + unit(random);
    material.thin = m == 2;
    material.unlit = m == 1, material.double_sided = m != 1;
    scene.materials.push_back(material);
  }
  for (std::uint32_t m = 0; m < 4; ++m) {
    scene.meshes.push_back(random_mesh(random, 3));
    for (int i = 0; i < 2; ++i) {
      Instance instance{"instance", m, {}};
      for (auto& row : instance.to_world.m) {
        for (float& x : row) x = unit(random) - 0.5f;
      }
      scene.instances.push_back(instance);
    }
  }
  return scene;
}

void add_lights_and_cameras(SceneDescription& scene) {
  Light light;
  light.name = "lamp", light.position = {1, 2, 3}, light.intensity = {100.5f, 0.1f, 3};
  light.range = 12.5f;
  scene.lights.push_back(light);
  light.type = Light::Type::kSpot, light.direction = {0.6f, -0.8f, 0};
  light.inner_angle = 0.25f, light.outer_angle = 0.5f;
  light.range = std::numeric_limits<float>::infinity();
  scene.lights.push_back(light);
  light.type = Light::Type::kDirectional, light.direction = {0, -1, 0};
  scene.lights.push_back(light);
  Camera camera;
  camera.name = "front", camera.to_world.m[2][3] = 7, camera.y_fov = 0.75f;
  scene.cameras.push_back(camera);
  camera.orthographic = true, camera.y_mag = 3, camera.z_far = 50;
  scene.cameras.push_back(camera);
}

void expect_same(const Material& a, const Material& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(std::memcmp(&a.base_color, &b.base_color, sizeof a.base_color), 0);
  for (const auto slot : {&Material::base_color_texture, &Material::metallic_roughness_texture,
                          &Material::emission_texture, &Material::normal_texture}) {
    EXPECT_EQ(std::memcmp(&(a.*slot), &(b.*slot), offsetof(TextureSlot, second_uvs)), 0);
    EXPECT_EQ((a.*slot).second_uvs, (b.*slot).second_uvs);
  }
  for (const auto number :
       {&Material::metallic, &Material::roughness, &Material::specular, &Material::transmission,
        &Material::ior, &Material::normal_scale, &Material::alpha_cutoff}) {
    EXPECT_EQ(a.*number, b.*number);
  }
  EXPECT_EQ(std::memcmp(&a.emission, &b.emission, sizeof a.emission), 0);
  EXPECT_EQ(std::memcmp(&a.specular_color, &b.specular_color, sizeof(Vec3)), 0);
  EXPECT_EQ(a.thin, b.thin);
  EXPECT_EQ(a.unlit, b.unlit);
  EXPECT_EQ(a.alpha_blend, b.alpha_blend);
  EXPECT_EQ(a.double_sided, b.double_sided);
}

std::uint32_t material_at(const Mesh& mesh, std::size_t t) {
  if (mesh.materials.empty()) return kInvalidId;
  return mesh.materials.size() == 1 ? mesh.materials[0] : mesh.materials[t];
}

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(same_bits(a.positions, b.positions));
  EXPECT_TRUE(same_bits(a.normals, b.normals));
  EXPECT_TRUE(same_bits(a.uvs, b.uvs));
  EXPECT_TRUE(same_bits(a.colors, b.colors));
  EXPECT_TRUE(same_bits(a.triangles, b.triangles));
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    ASSERT_EQ(material_at(a, t), material_at(b, t)) << t;
  }
}

void expect_same(const SceneDescription& a, const SceneDescription& b) {
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) expect_same(a.meshes[i], b.meshes[i]);
  ASSERT_EQ(a.instances.size(), b.instances.size());
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].mesh, b.instances[i].mesh);
    EXPECT_EQ(a.instances[i].to_world.m, b.instances[i].to_world.m);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) expect_same(a.materials[i], b.materials[i]);
  ASSERT_EQ(a.images.size(), b.images.size());
  for (std::size_t i = 0; i < a.images.size(); ++i) EXPECT_EQ(a.images[i].rgba, b.images[i].rgba);
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (std::size_t i = 0; i < a.textures.size(); ++i) {
    EXPECT_EQ(std::memcmp(&a.textures[i], &b.textures[i], 7), 0);
  }
}

TEST_F(Write, GlbIsReadBackBitForBit) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SceneDescription scene = random_scene(seed);
    add_lights_and_cameras(scene);
    save_glb(scene, path("a.glb"));
    const SceneDescription again = load_scene(path("a.glb"));
    expect_same(scene, again);
    ASSERT_EQ(again.warnings.size(), 1u);
    EXPECT_NE(again.warnings[0].find("BLEND"), std::string::npos);
    ASSERT_EQ(again.lights.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const Light &a = scene.lights[i], &b = again.lights[i];
      EXPECT_EQ(a.type, b.type);
      EXPECT_EQ(a.intensity.x, b.intensity.x);
      EXPECT_EQ(a.intensity.y, b.intensity.y);
      EXPECT_EQ(a.range, b.range);
      EXPECT_TRUE(a.type == Light::Type::kDirectional || a.position.z == b.position.z);
      EXPECT_TRUE(a.type == Light::Type::kPoint ||
                  std::fabs(a.direction.y - b.direction.y) < 1e-6f);
      EXPECT_TRUE(a.type != Light::Type::kSpot || a.inner_angle == b.inner_angle);
    }
    ASSERT_EQ(again.cameras.size(), 2u);
    EXPECT_EQ(again.cameras[0].to_world.m, scene.cameras[0].to_world.m);
    EXPECT_EQ(again.cameras[0].y_fov, 0.75f);
    EXPECT_TRUE(std::isinf(again.cameras[0].z_far));
    EXPECT_EQ(again.cameras[1].y_mag, 3);
    EXPECT_EQ(again.cameras[1].z_far, 50);
  }
}

TEST_F(Write, RealScenesAreReadBackBitForBit) {
  for (const char* name : {"paper/office.glb", "cornell_variants/mcguire/CornellBox-Water.obj"}) {
    RAYSHEAF_SCENE_OR_SKIP(source, name);
    const SceneDescription scene = load_scene(source);
    save_glb(scene, path("a.glb"));
    expect_same(scene, load_scene(path("a.glb")));
  }
}

TEST_F(Write, GlbIsRefusedForInvalidScenes) {
  SceneDescription scene = random_scene(1);
  scene.meshes[1].triangles[0][2] = 1000;
  try {
    save_glb(scene, path("a.glb"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(error.place().find("meshes[1].triangles[0]"), std::string::npos) << error.what();
  }
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(Write, PngHasAlphaOnlyWhereItIsNeeded) {
  Image image{"", 5, 3, {}};
  for (int i = 0; i < 60; ++i)
    image.rgba.push_back(static_cast<std::uint8_t>(i % 4 == 3 ? 255 : i));
  for (const bool opaque : {true, false}) {
    if (!opaque) image.rgba[7] = 254;
    write_png(image, path("a.png"));
    const std::string bytes = read("a.png");
    EXPECT_EQ(bytes[25], opaque ? 2 : 6) << "the colour type of the PNG";
    const auto decoded = io::decode_image(io::as_bytes(bytes));
    ASSERT_TRUE(decoded.has_value());
    EXPECT_EQ(decoded->width, 5u);
    EXPECT_EQ(decoded->rgba, image.rgba);
  }
  image.rgba.pop_back();
  EXPECT_THROW(write_png(image, path("b.png")), Error);
  EXPECT_THROW(write_png(Image{}, path("b.png")), Error);
  EXPECT_FALSE(std::filesystem::exists(path("b.png")));
}

/// Images that compress in every way: not at all, by runs, by rows, to a single code.
Image picture_of(int kind, std::uint32_t width, std::uint32_t height, std::mt19937& random) {
  Image image{"", width, height, {}};
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t noise = static_cast<std::uint32_t>(random());
      const std::uint32_t of[] = {noise,     0x7f7f7f7fu,      x * 3 + (y << 9) + (x * y << 16),
                                  x * x / 5, y % 7 * 0x31313u, noise & (x / 40 * 0x01010101u)};
      for (int c = 0; c < 4; ++c)
        image.rgba.push_back(
            static_cast<std::uint8_t>(c == 3 && kind != 0 ? 255 : of[kind] >> 8 * c));
    }
  }
  return image;
}

TEST_F(Write, PngIsReadBackWhateverItShows) {
  std::mt19937 random(7);
  for (int kind = 0; kind < 6; ++kind) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 9u}, {300u, 1u}, {311u, 257u}}) {
      const Image image = picture_of(kind, width, height, random);
      const std::vector<std::uint8_t> png = encode_png(image);
      const auto decoded = io::decode_image(png);
      ASSERT_TRUE(decoded.has_value()) << kind << " " << width << " x " << height;
      EXPECT_EQ(decoded->rgba, image.rgba) << kind << " " << width << " x " << height;
      if (kind == 1 && width > 300) {
        EXPECT_LT(png.size(), 2500u);
      }
      if (kind == 0) {
        EXPECT_LT(png.size(), image.rgba.size() * 21 / 20 + 400);
      }
    }
  }
}

TEST_F(Write, ExrIsReadBackBitForBit) {
  constexpr std::uint32_t kWidth = 37, kHeight = 21;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> anywhere(-1e6f, 1e6f);
  std::vector<ExrChannel> channels;
  for (const char* name : {"normal.Z", "R", "G", "B", "tests.V"}) {
    channels.push_back({name, {}});
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
      channels.back().values.push_back(anywhere(random));
    }
  }
  channels[0].values[5] = std::numeric_limits<float>::infinity();
  write_exr(kWidth, kHeight, channels, path("a.exr"));

  Imf::InputFile file(path("a.exr").c_str());
  const Imath::Box2i window = file.header().dataWindow();
  EXPECT_EQ(window, Imath::Box2i({0, 0}, {kWidth - 1, kHeight - 1}));
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  const char* sorted[] = {"B", "G", "R", "normal.Z", "tests.V"};
  const std::size_t source[] = {3, 2, 1, 0, 4};
  std::vector<std::vector<float>> planes(5, std::vector<float>(kWidth * kHeight));
  Imf::FrameBuffer all;
  std::size_t count = 0;
  for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it) {
    ASSERT_LT(count, 5u);
    EXPECT_STREQ(it.name(), sorted[count]);
    EXPECT_EQ(it.channel().type, Imf::FLOAT);
    all.insert(it.name(), Imf::Slice::Make(Imf::FLOAT, planes[count++].data(), window));
  }
  file.setFrameBuffer(all);
  file.readPixels(window.min.y, window.max.y);
  for (std::size_t c = 0; c < 5; ++c)
    EXPECT_EQ(std::memcmp(planes[c].data(), channels[source[c]].values.data(),
                          sizeof(float) * kWidth * kHeight),
              0);
}

TEST_F(Write, ExrRefusesInvalidImages) {
  const std::vector<ExrChannel> one = {{"R", {1, 2}}};
  EXPECT_THROW(write_exr(1, 1, one, path("a.exr")), Error);
  EXPECT_THROW(write_exr(0, 1, one, path("a.exr")), Error);
  EXPECT_THROW(write_exr(1, 2, {}, path("a.exr")), Error);
  EXPECT_THROW(write_exr(1, 2, {one[0], one[0]}, path("a.exr")), Error);
  EXPECT_THROW(write_exr(1, 2, {{"", {1, 2}}}, path("a.exr")), Error);
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(Write, ReplacesTheOldFileWholly) {
  write("a.json", std::string(1000, 'x'));
  write_text("new", path("a.json"));
  EXPECT_EQ(read("a.json"), "new");
  EXPECT_EQ(file_count(), 1u) << "no temporary file is left";
}

TEST_F(Write, KeepsDevicesAndLinks) {
  write_text("text", "/dev/null");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  write("a.json", std::string("old"));
  std::filesystem::create_symlink("a.json", path("link.json"));
  write_text("new", path("link.json"));
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.json")));
  EXPECT_EQ(read("a.json"), "new");
}

TEST_F(Write, FollowsLinksToMissingFiles) {
  std::filesystem::create_directory(path("there"));
  std::filesystem::create_symlink("second.json", path("first.json"));
  std::filesystem::create_symlink("there/a.json", path("second.json"));
  write_text("new", path("first.json"));
  EXPECT_TRUE(std::filesystem::is_symlink(path("first.json")));
  EXPECT_TRUE(std::filesystem::is_symlink(path("second.json")));
  EXPECT_EQ(read("there/a.json"), "new");
}

void expect_io_error(const std::string& path) {
  try {
    write_text("text", path);
    ADD_FAILURE() << path;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), kIo);
    EXPECT_EQ(error.place(), path);
    EXPECT_NE(error.sentence().find("cannot be written"), std::string::npos);
  }
}

TEST_F(Write, NamesTheFileThatCannotBeWritten) {
  expect_io_error(path("no/such/folder/a.json"));
  std::filesystem::create_directory(path("folder"));
  expect_io_error(path("folder"));
  expect_io_error("/proc/a.json");
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(Write, RefusesLinksInACircle) {
  std::filesystem::create_symlink("b.json", path("a.json"));
  std::filesystem::create_symlink("a.json", path("b.json"));
  expect_io_error(path("a.json"));
  EXPECT_EQ(file_count(), 2u);
}

// The file's link in /proc names a deleted file.
TEST_F(Write, RefusesAFileWithoutAName) {
  write("a.json", std::string("old"));
  const int file = ::open(path("a.json").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(file, 0);
  std::filesystem::remove(path("a.json"));
  expect_io_error("/proc/self/fd/" + std::to_string(file));
  ::close(file);
  EXPECT_EQ(file_count(), 0u);
}

/// A limit on file sizes simulates a full disk: the write begins and then fails.
TEST_F(Write, LeavesNothingHalfWrittenOnAFullDisk) {
  write("a.json", std::string("old"));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 1000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_text(std::string(5000, 'x'), path("a.json")), Error);
  EXPECT_THROW(write_text(std::string(5000, 'x'), path("b.json")), Error);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read("a.json"), "old");
  EXPECT_EQ(file_count(), 1u);
}

/// With equal names, each process would rename the other's file.
TEST_F(Write, ForkedProcessesHaveNamesOfTheirOwn) {
  static_cast<void>(io::temporary_name("a"));
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::string name = io::temporary_name("a");
    ::_exit(::write(ends[1], name.data(), name.size()) == std::ssize(name) ? 0 : 1);
  }
  const std::string own = io::temporary_name("a");
  std::string others(own.size() + 20, ' ');
  const ssize_t size = ::read(ends[0], others.data(), others.size());
  ASSERT_GT(size, 0);
  others.resize(static_cast<std::size_t>(size));
  EXPECT_EQ(::waitpid(child, nullptr, 0), child);
  ::close(ends[0]);
  ::close(ends[1]);
  EXPECT_NE(others, own);
}

TEST_F(Write, LeavesTheOldFileWhereTheFolderIsReadOnly) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  write("a.json", std::string("old"));
  std::filesystem::permissions(
      folder_, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  expect_io_error(path("a.json"));
  EXPECT_EQ(read("a.json"), "old");
}

}  // namespace
}  // namespace raysheaf::test
