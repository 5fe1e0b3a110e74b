// Meshes from glTF: component types, strides, sparse values, modes, normals.
#include <cmath>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using GltfGeometry = IoTest;

constexpr int kByte = 5120, kUbyte = 5121, kShort = 5122, kUshort = 5123, kUint = 5125;

const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};
const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

TEST_F(GltfGeometry, ReadsTheSameFromDataUriExternalBufferAndGlb) {
  GltfFile file;
  file.show_triangle();
  std::string name = "a b.bin";
  write(name, Bytes(file.buffer.begin(), file.buffer.end()));
  // A buffer's file may be longer than the buffer.
  write("long.bin", [&] {
    Bytes longer = file.buffer;
    longer.push_back(7);
    return longer;
  }());
  for (const std::string& path :
       {write("embedded.gltf", file.text()), write("external.gltf", file.text("a%20b.bin")),
        write("longer.gltf", file.text("long.bin")), write("packed.glb", file.glb()),
        write("upper.GLB", file.glb())}) {
    const SceneDescription scene = load_scene(path);
    ASSERT_EQ(scene.meshes.size(), 1u) << path;
    ASSERT_EQ(scene.triangle_count(), 1u) << path;
    EXPECT_EQ(scene.meshes[0].positions[1].x, 1) << path;
    EXPECT_TRUE(scene.meshes[0].normals.empty()) << path;
    EXPECT_TRUE(scene.warnings.empty()) << path;
  }
}

TEST_F(GltfGeometry, ReadsEveryIndexTypeAndNone) {
  const json attributes_at = {{"POSITION", 0}};
  for (int type : {kUbyte, kUshort, kUint}) {
    GltfFile file;
    file.positions(kSquare);
    std::size_t indices = 0;
    if (type == kUbyte) indices = file.accessor<std::uint8_t>({2, 3, 0}, "SCALAR", type, 1);
    if (type == kUshort) indices = file.accessor<std::uint16_t>({2, 3, 0}, "SCALAR", type, 1);
    if (type == kUint) indices = file.accessor<std::uint32_t>({2, 3, 0}, "SCALAR", type, 1);
    file.show({{"attributes", attributes_at}, {"indices", indices}});
    const SceneDescription scene = load_scene(write("a.gltf", file.text()));
    const std::array<std::uint32_t, 3> expected = {2, 3, 0};
    ASSERT_EQ(scene.triangle_count(), 1u);
    EXPECT_EQ(scene.meshes[0].triangles[0], expected) << type;
  }
}

TEST_F(GltfGeometry, CutsStripsAndFansWithTheirWinding) {
  const std::vector<std::array<std::uint32_t, 3>> strip = {{0, 1, 2}, {1, 3, 2}};
  const std::vector<std::array<std::uint32_t, 3>> fan = {{1, 2, 0}, {2, 3, 0}};
  for (int mode : {5, 6}) {
    GltfFile file;
    file.show({{"attributes", {{"POSITION", file.positions(kSquare)}}}, {"mode", mode}});
    const SceneDescription scene = load_scene(write("a.gltf", file.text()));
    EXPECT_EQ(scene.meshes[0].triangles, mode == 5 ? strip : fan);
  }
}

TEST_F(GltfGeometry, LeavesOutPointsAndLinesWithOneWarning) {
  GltfFile file;
  const std::size_t positions = file.positions(kTriangle);
  const json at = {{"POSITION", positions}};
  file.add("meshes", {{"primitives",
                       {{{"attributes", at}, {"mode", 0}},
                        {{"attributes", at}, {"mode", 2}},
                        {{"attributes", at}}}}});
  file.node({{"mesh", 0}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(scene.triangle_count(), 1u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(warns(scene, "Points and lines"));
}

TEST_F(GltfGeometry, ScalesNormalizedIntegers) {
  GltfFile file;
  // Three bytes and one of padding: elements begin at multiples of four.
  const std::vector<std::int8_t> bytes = {127, 0, 0, 0, 0, 127, 0, 0, -128, -127, 0, 0};
  file.accessor(bytes, "VEC3", kByte, 4, true);
  file.json["bufferViews"][0]["byteStride"] = 4;
  const std::size_t uvs =
      file.accessor<std::uint16_t>({0, 0, 65535, 0, 0, 32768}, "VEC2", kUshort, 2, true);
  file.show({{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", uvs}}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions[0].x, 1);
  EXPECT_EQ(mesh.positions[1].y, 1);
  EXPECT_EQ(mesh.positions[2].x, -1);
  EXPECT_EQ(mesh.positions[2].y, -1);
  EXPECT_EQ(mesh.uvs[1].x, 1);
  EXPECT_EQ(mesh.uvs[2].y, 32768.0f / 65535.0f);
}

TEST_F(GltfGeometry, KeepsPlainIntegersAsTheyAre) {
  GltfFile file;
  file.accessor<std::int16_t>({0, 0, 0, 0, 300, 0, 0, 0, 0, -20, 0, 0}, "VEC3", kShort, 4);
  file.json["bufferViews"][0]["byteStride"] = 8;
  file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.show({{"attributes", {{"POSITION", 0}}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(scene.meshes[0].positions[1].x, 300);
  EXPECT_EQ(scene.meshes[0].positions[2].y, -20);
}

TEST_F(GltfGeometry, ReadsInterleavedAttributes) {
  GltfFile file;
  const std::size_t view = file.view<float>({0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1});
  file.json["bufferViews"][view]["byteStride"] = 24;
  json accessor = {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
  file.add("accessors", accessor);
  accessor["byteOffset"] = 12;
  file.add("accessors", accessor);
  file.show({{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(scene.meshes[0].positions[2].y, 1);
  EXPECT_EQ(scene.meshes[0].normals[2].z, 1);
}

TEST_F(GltfGeometry, AppliesSparseValuesWithAndWithoutABase) {
  for (const bool base : {true, false}) {
    GltfFile file;
    if (base)
      file.positions(kTriangle);
    else
      file.add("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    file.json["accessors"][0]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", file.view<std::uint8_t>({1, 2})}, {"componentType", kUbyte}}},
        {"values", {{"bufferView", file.view<float>({5, 0, 0, 0, 6, 0})}}}};
    file.show({{"attributes", {{"POSITION", 0}}}});
    const SceneDescription scene = load_scene(write("a.gltf", file.text()));
    EXPECT_EQ(scene.meshes[0].positions[0].x, 0);
    EXPECT_EQ(scene.meshes[0].positions[1].x, 5);
    EXPECT_EQ(scene.meshes[0].positions[2].y, 6);
  }
}

TEST_F(GltfGeometry, MakesOneMeshOfAllPrimitivesAndSharesTheirVertices) {
  GltfFile file;
  const std::size_t positions = file.positions(kSquare);
  const std::size_t first = file.accessor<std::uint8_t>({0, 1, 2}, "SCALAR", kUbyte, 1);
  const std::size_t second = file.accessor<std::uint8_t>({0, 2, 3}, "SCALAR", kUbyte, 1);
  file.add("materials", {{"name", "a"}});
  file.add("materials", {{"name", "b"}});
  const json at = {{"POSITION", positions}};
  file.add("meshes", {{"name", "square"},
                      {"primitives",
                       {{{"attributes", at}, {"indices", first}, {"material", 1}},
                        {{"attributes", at}, {"indices", second}, {"material", 0}}}}});
  file.node({{"mesh", 0}});
  file.node({{"mesh", 0}, {"name", "again"}, {"translation", {0, 0, 5}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
  EXPECT_EQ(scene.meshes[0].materials, (std::vector<std::uint32_t>{1, 0}));
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].name, "square");
  EXPECT_EQ(scene.instances[1].name, "again");
  EXPECT_EQ(scene.instances[1].to_world.m[2][3], 5);
}

TEST_F(GltfGeometry, KeepsPrimitivesWithoutNormalsFlatBesideOthers) {
  GltfFile file;
  const std::size_t smooth = file.positions(kSquare);
  const std::size_t normals = file.positions({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const std::size_t indices = file.accessor<std::uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR", kUbyte, 1);
  const std::size_t flat = file.positions({0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1});
  file.add("meshes",
           {{"primitives",
             {{{"attributes", {{"POSITION", smooth}, {"NORMAL", normals}}}, {"indices", indices}},
              {{"attributes", {{"POSITION", flat}}}, {"indices", indices}}}}});
  file.node({{"mesh", 0}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 4u);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (std::size_t t = 2; t < 4; ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) EXPECT_EQ(mesh.normals[v].x, 1);
  }
  EXPECT_NE(mesh.triangles[2][0], mesh.triangles[3][0]) << "flat triangles share no vertex";
}

TEST_F(GltfGeometry, ReplacesNormalsOfNoLength) {
  GltfFile file;
  file.show({{"attributes",
              {{"POSITION", file.positions(kTriangle)},
               {"NORMAL", file.positions({0, 0, 2, 0, 0, 0, 0, 0, 1})}}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  for (const Vec3& n : scene.meshes[0].normals) EXPECT_EQ(n.z, 1);
  EXPECT_TRUE(warns(scene, "length zero"));
}

TEST_F(GltfGeometry, ReadsColoursOfVertices) {
  GltfFile file;
  const std::size_t at = file.positions(kTriangle);
  const std::size_t bytes = file.accessor<std::uint8_t>(
      {255, 0, 51, 7, 0, 255, 0, 0, 51, 51, 51, 255}, "VEC4", kUbyte, 4, true);
  const std::size_t floats =
      file.accessor<float>({1, 0, 0.25f, 2, -1, 0, 0, 0, 1}, "VEC3", 5126, 3);
  const auto primitive = [&](std::size_t color) {
    return json{{"attributes", {{"POSITION", at}, {"COLOR_0", color}}}};
  };
  const json bare = {{"attributes", {{"POSITION", at}}}};
  file.add("meshes", {{"primitives", {bare, primitive(bytes), primitive(floats), bare}}});
  file.node({{"mesh", 0}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  const std::vector<Vec3>& colors = scene.meshes[0].colors;
  ASSERT_EQ(colors.size(), 9u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 9u);
  EXPECT_EQ(colors[0].y, 1) << "white next to coloured primitives";
  EXPECT_EQ(colors[3].x, 1);
  EXPECT_FLOAT_EQ(colors[3].z, 0.2f) << "linear";
  EXPECT_FLOAT_EQ(colors[5].x, 0.2f);
  EXPECT_EQ(colors[6].z, 0.25f);
  EXPECT_EQ(colors[7].x, 1) << "no more than white";
  EXPECT_EQ(colors[7].y, 0);
  EXPECT_TRUE(scene.warnings.empty());
  file.accessor<float>({1, 2, 3, 4, 5, 6}, "VEC2", 5126, 2);
  file.json["meshes"][0]["primitives"][1]["attributes"]["COLOR_0"] = 3;
  expect_refused(write("b.gltf", file.text()), ErrorCode::kInvalidData, {"COLOR_0"});
}

TEST_F(GltfGeometry, WarnsOfIgnoredDataOfMorphTargets) {
  GltfFile file;
  const std::size_t at = file.positions(kTriangle);
  const json target = {{"POSITION", at}, {"COLOR_0", at}, {"TEXCOORD_0", at}};
  file.show({{"attributes", {{"POSITION", at}}}, {"targets", {target}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_TRUE(warns(scene, "Colours of morph targets"));
  EXPECT_TRUE(warns(scene, "Texture coordinates of morph targets"));
}

TEST_F(GltfGeometry, ReadsTheCoordinatesThatTheBaseColourNames) {
  GltfFile file;
  const std::size_t other = file.accessor<float>({9, 9, 9, 9, 9, 9}, "VEC2", 5126, 2);
  const std::size_t right = file.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", 5126, 2);
  file.add("images", {{"uri", "missing.png"}});
  file.add("textures", {{"source", 0}});
  file.add("materials",
           {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}},
            {"emissiveTexture", {{"index", 0}}}});
  file.show(
      {{"material", 0},
       {"attributes",
        {{"POSITION", file.positions(kTriangle)}, {"TEXCOORD_0", other}, {"TEXCOORD_1", right}}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(scene.meshes[0].uvs[1].x, 1);
  EXPECT_EQ(scene.meshes[0].second_uvs[1].x, 9) << "those of the emission";
  EXPECT_TRUE(warns(scene, "images[0] \"missing.png\" is missing"));
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, kInvalidId);
}

}  // namespace
}  // namespace raysheaf::test
