// A small file allocates little memory, and cannot refer to files outside its folder.
#include "io/refuse.h"
#include "io_support.h"

namespace raysheaf::test {
namespace {

using Limits = IoTest;
using Json = nlohmann::json;

/// A file with accessors of `elements` elements without bytes, each in a mesh, and each mesh in
/// many places.
std::string unbacked(std::size_t elements, int meshes, int places) {
  Json root = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  root["accessors"] =
      Json::array({{{"componentType", 5126}, {"count", elements}, {"type", "VEC3"}}});
  Json nodes = Json::array(), all = Json::array(), list = Json::array();
  for (int m = 0; m < meshes; ++m)
    all.push_back({{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 5}}}}});
  for (int n = 0; n < places; ++n) {
    nodes.push_back({{"mesh", n % meshes}});
    list.push_back(n);
  }
  root["meshes"] = all, root["nodes"] = nodes;
  root["scenes"] = Json::array({{{"nodes", list}}});
  return root.dump();
}

void expect_beyond_limit(const std::string& path, ErrorCode code, const std::string& words) {
  try {
    static_cast<void>(load_scene(path));
    FAIL() << "was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST_F(Limits, ElementsWithoutBytes) {
  expect_beyond_limit(write("a.gltf", unbacked((1 << 18) + 1, 1, 1)), ErrorCode::kOutOfMemory,
                      "accessors[0].count");
  expect_beyond_limit(write("b.gltf", unbacked(1 << 18, 40, 40)), ErrorCode::kOutOfMemory,
                      "far more memory");
  EXPECT_NO_THROW(static_cast<void>(load_scene(write("c.gltf", unbacked(1 << 16, 2, 2)))));
}

/// Data without an accessor counts as well: empty morph targets, vertices of flat triangles next to
/// others, and joints for vertices of which only one has many.
TEST_F(Limits, VerticesWithoutAccessors) {
  Json root = Json::parse(unbacked(1 << 18, 1, 1));
  Json& primitives = root["meshes"][0]["primitives"];
  const Json plain = primitives[0];
  primitives[0]["targets"] = Json::array();
  for (int t = 0; t < 100; ++t) primitives[0]["targets"].push_back(Json::object());
  expect_beyond_limit(write("targets.gltf", root.dump()), ErrorCode::kOutOfMemory,
                      "meshes[0].primitives[0]: the meshes would take far more memory");
  root["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  primitives = Json::array({plain, plain, plain, plain, plain});
  primitives[0] = {{"attributes", {{"POSITION", 1}, {"NORMAL", 1}}}};
  expect_beyond_limit(write("flat.gltf", root.dump()), ErrorCode::kOutOfMemory,
                      "meshes[0].primitives[3]: the meshes would take far more memory");
  root["accessors"].push_back({{"componentType", 5126}, {"count", 1 << 18}, {"type", "VEC4"}});
  root["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC4"}});
  root["skins"] = {{{"joints", {0}}}};
  root["nodes"][0]["skin"] = 0;
  primitives = Json::array({plain, plain});
  primitives[0]["attributes"].update({{"JOINTS_0", 2}, {"WEIGHTS_0", 2}});
  primitives[1]["attributes"]["POSITION"] = 1;
  for (int set = 0; set < 50; ++set)
    for (const char* name : {"JOINTS_", "WEIGHTS_"})
      primitives[1]["attributes"][name + std::to_string(set)] = 3;
  expect_beyond_limit(write("joints.gltf", root.dump()), ErrorCode::kOutOfMemory,
                      "meshes[0].primitives[1]: the meshes would take far more memory");
}

/// Many instances of a small mesh, each with its own shape.
TEST_F(Limits, CrowdsOfShapes) {
  constexpr std::size_t kVertices = 2000;
  GltfFile file;
  std::vector<float> values(3 * kVertices, 0.5f);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += static_cast<float>(i % 7);
  const std::size_t positions = file.positions(values);
  file.show({{"attributes", {{"POSITION", positions}}}, {"targets", {{{"POSITION", positions}}}}});
  for (int n = 1; n < 800; ++n) file.node({{"mesh", 0}, {"weights", {n}}});
  EXPECT_EQ(load_scene(write("a.gltf", file.text())).meshes.size(), 800u);
}

TEST_F(Limits, InstancesWithoutEnd) {
  expect_beyond_limit(write("a.gltf", unbacked(1 << 18, 1, 60)), ErrorCode::kOutOfMemory,
                      "far more triangles");
}

/// A PNG with one grey channel that ends after its header.
Bytes headless_png(std::uint32_t side) {
  Bytes png{0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
  for (int axis = 0; axis < 2; ++axis)
    for (int shift = 24; shift >= 0; shift -= 8)
      png.push_back(static_cast<std::uint8_t>(side >> shift));
  png.insert(png.end(), {8, 0, 0, 0, 0, 0, 0, 0, 0});
  return png;
}

std::string square_with_picture(const std::string& name) {
  return "mtllib " + name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
}

TEST_F(Limits, PixelsWithoutBytes) {
  write("a.png", headless_png(8000));
  write("a.mtl", std::string("newmtl a\nmap_Kd a.png\n"));
  const SceneDescription scene = load_scene(write("a.obj", square_with_picture("a.mtl")));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("a.png"), std::string::npos);
  EXPECT_TRUE(scene.images.empty());
}

TEST_F(Limits, PicturesThatAreTooLargeAreLeftOutByName) {
  Bytes large = headless_png(16384);
  large.resize(50000);
  write("large.png", large);
  Bytes each = headless_png(8192);
  each.resize(20000);
  std::string materials = "newmtl a\nmap_Kd large.png\n", faces;
  for (int i = 0; i < 5; ++i) {
    const std::string number = std::to_string(i);
    write("t" + number + ".png", each);
    materials += "newmtl m" + number + "\nmap_Kd t" + number + ".png\n";
    faces += "usemtl m" + number + "\nf 1 2 3\n";
  }
  write("a.mtl", materials);
  const SceneDescription scene = load_scene(write("a.obj", square_with_picture("a.mtl") + faces));
  EXPECT_TRUE(warns(scene, "\"large.png\" has 16384x16384 pixels, more than 2^26"));
  EXPECT_TRUE(warns(scene, "\"t3.png\" is truncated")) << "within the limits";
  EXPECT_TRUE(warns(scene,
                    "\"t4.png\" has 8192x8192 pixels, with which the images together "
                    "exceed the limit of 2^28"));
}

TEST_F(Limits, PicturesThatFuzzingFound) {
  for (const auto& file : std::filesystem::directory_iterator(std::string(RAYSHEAF_SOURCE_DIR) +
                                                              "/tests/fuzz/found/image")) {
    std::filesystem::copy_file(file, path("a.png"),
                               std::filesystem::copy_options::overwrite_existing);
    write("a.mtl", std::string("newmtl a\nmap_Kd a.png\n"));
    const SceneDescription scene = load_scene(write("a.obj", square_with_picture("a.mtl")));
    EXPECT_TRUE(scene.images.empty()) << file.path();
  }
}

TEST_F(Limits, NamesThatLeaveTheFolder) {
  write("m.mtl", std::string("newmtl a\nKd 1 0 0\n"));
  for (const std::string& name : {std::string("../m.mtl"), path("m.mtl")}) {
    const std::string file = write("inner/a.obj", square_with_picture(name));
    const SceneDescription kept_out = load_scene(file);
    EXPECT_FALSE(kept_out.warnings.empty()) << name;
    EXPECT_EQ(kept_out.materials[0].name, "default") << name;
    const SceneDescription let_in = load_scene(file, {.allow_external = true});
    EXPECT_TRUE(let_in.warnings.empty()) << let_in.warnings[0];
    EXPECT_EQ(let_in.materials[0].name, "a") << name;
  }
}

TEST_F(Limits, BuffersThatLeaveTheFolder) {
  write("corners.bin", Bytes(36, 0));
  Json root = Json::parse(unbacked(3, 1, 1));
  root["buffers"] = {{{"byteLength", 36}, {"uri", "../corners.bin"}}};
  root["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}}};
  root["accessors"][0]["bufferView"] = 0;
  const std::string file = write("inner/a.gltf", root.dump());
  expect_beyond_limit(file, ErrorCode::kUnsupported, "does not stay inside the file's folder");
  EXPECT_EQ(load_scene(file, {.allow_external = true}).triangle_count(), 1u);
  root["buffers"][0]["uri"] = path("corners.bin");
  write("inner/a.gltf", root.dump());
  EXPECT_THROW(static_cast<void>(load_scene(file, {.allow_external = true})), Error);
}

/// A file may request such a size by a wrong count.
TEST(WithinMemory, MoreThanAnyVectorHoldsIsALackOfMemory) {
  const auto reserve = [] {
    std::vector<int> all;
    all.reserve(all.max_size() + 1);
  };
  const auto expect_lack = [](const auto& body) {
    try {
      body();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << error.what();
      EXPECT_EQ(error.place(), "a.file");
    }
  };
  expect_lack([&] { io::within_memory("a.file", reserve); });
  expect_lack([&] { io::naming("a.file", reserve); });
}

}  // namespace
}  // namespace raysheaf::test
