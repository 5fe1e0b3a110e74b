// The appearance of PLY files: textures, face colours, colours in bytes; and files of points.
#include "tests/io/pack_support.h"

namespace raysheaf::test {
namespace {

using enum ErrorCode;

class PlyLook : public PackTest {
 protected:
  void SetUp() override {
    write_png({"", 1, 1, {200, 0, 0, 255}}, path("red.png"));
    write_png({"", 1, 1, {0, 200, 0, 255}}, path("green image.png"));
  }
  /// An ASCII file with a square of two triangles. `columns` follow x, y and z of each vertex.
  SceneDescription load(const std::string& comments, const std::string& vertex,
                        const std::array<std::string, 4>& columns, const std::string& face,
                        const std::array<std::string, 2>& ends) {
    const char* const places[] = {"0 0 0 ", "1 0 0 ", "1 1 0 ", "0 1 0 "};
    std::string text = "ply\nformat ascii 1.0\n" + comments +
                       "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
                       vertex + "element face 2\nproperty list uchar int vertex_indices\n" + face +
                       "end_header\n";
    for (std::size_t v = 0; v < 4; ++v) text += places[v] + columns[v] + "\n";
    text += "3 0 1 2 " + ends[0] + "\n3 0 2 3 " + ends[1] + "\n";
    return load_scene(write("a.ply", text));
  }
  static const Image* image_of(const SceneDescription& scene, std::size_t triangle) {
    const Mesh& mesh = scene.meshes[0];
    const Material& material =
        scene.materials[mesh.materials[mesh.materials.size() == 1 ? 0 : triangle]];
    const std::uint32_t texture = material.base_color_texture.texture;
    return texture == kInvalidId ? nullptr : &scene.images[scene.textures[texture].image];
  }
  static void expect_uvs(const SceneDescription& scene, std::size_t triangle,
                         const std::array<Vec2, 3>& expected) {
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.uvs[mesh.triangles[triangle][k]].x, expected[k].x) << triangle << k;
      EXPECT_EQ(mesh.uvs[mesh.triangles[triangle][k]].y, expected[k].y) << triangle << k;
    }
  }
  /// The colour of a triangle's corner, multiplied with its material's.
  static Vec3 color_of(const SceneDescription& scene, std::size_t triangle, std::size_t corner) {
    const Mesh& mesh = scene.meshes[0];
    const Vec4 base = scene.materials[mesh.materials[0]].base_color;
    if (mesh.colors.empty()) return {base.x, base.y, base.z};
    const Vec3 own = mesh.colors[mesh.triangles[triangle][corner]];
    return {own.x * base.x, own.y * base.y, own.z * base.z};
  }
  static void expect_color(Vec3 color, Vec3 expected) {
    EXPECT_NEAR(color.x, expected.x, 1e-6);
    EXPECT_NEAR(color.y, expected.y, 1e-6);
    EXPECT_NEAR(color.z, expected.z, 1e-6);
  }
};

constexpr float kHalf = 0.2158605f;  // 128 in sRGB
const std::array<std::string, 4> kCorners = {"0 0", "1 0", "1 1", "0 0.75"};
const std::array<std::string, 4> kNothing;
const std::array<std::string, 2> kNoEnds;

TEST_F(PlyLook, ShowsTheTextureAtCoordinatesOfVertices) {
  for (const auto& [u, v] :
       {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}) {
    const std::string properties =
        std::string("property float ") + u + "\nproperty float " + v + "\n";
    for (const char* name : {"red.png", "\"red.png\"", "RED.png"}) {
      const SceneDescription scene = load(std::string("comment TextureFile ") + name + "\n",
                                          properties, kCorners, "", kNoEnds);
      ASSERT_NE(image_of(scene, 0), nullptr) << u;
      EXPECT_EQ(image_of(scene, 0)->rgba[0], 200);
      EXPECT_EQ(scene.materials[0].base_color.x, 1);
      expect_uvs(scene, 1, {Vec2{0, 1}, Vec2{1, 0}, Vec2{0, 0.25f}});
      EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
    }
  }
  EXPECT_TRUE(
      load("", "property float s\nproperty float t\n", kCorners, "", kNoEnds).meshes[0].uvs.empty())
      << "no image is named";
  const SceneDescription gone = load("comment TextureFile gone.png\n",
                                     "property float s\nproperty float t\n", kCorners, "", kNoEnds);
  EXPECT_TRUE(warns(gone, "gone.png"));
  EXPECT_EQ(gone.materials.size(), 1u);
}

TEST_F(PlyLook, SplitsVerticesWhereCornersHaveCoordinates) {
  const SceneDescription scene =
      load("comment TextureFile red.png\n", "", kNothing, "property list uchar float texcoord\n",
           {"6 0 0 1 0 1 1", "6 0 0 1 1 0.5 0.25"});
  ASSERT_NE(image_of(scene, 1), nullptr);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u) << "where they agree nothing is split";
  expect_uvs(scene, 1, {Vec2{0, 1}, Vec2{1, 0}, Vec2{0.5f, 0.75f}});
  const SceneDescription split =
      load("comment TextureFile red.png\n", "", kNothing, "property list uchar float texcoord\n",
           {"6 0 0 1 0 1 1", "6 0.5 0 1 1 0 1"});
  EXPECT_EQ(split.meshes[0].positions.size(), 5u);
  EXPECT_EQ(split.meshes[0].normals.size(), 5u);
  expect_uvs(split, 0, {Vec2{0, 1}, Vec2{1, 1}, Vec2{1, 0}});
  expect_uvs(split, 1, {Vec2{0.5f, 1}, Vec2{1, 0}, Vec2{0, 0}});
  EXPECT_EQ(split.meshes[0].positions[split.meshes[0].triangles[1][0]].x, 0);
}

TEST_F(PlyLook, TakesTheTextureThatAFaceNames) {
  const std::string names = "comment TextureFile red.png\ncomment TextureFile green image.png\n";
  const std::string face = "property list uchar float texcoord\nproperty int texnumber\n";
  const std::string corners = "6 0 0 1 0 1 1 ";
  const SceneDescription scene = load(names, "", kNothing, face, {corners + "1", corners + "0"});
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(image_of(scene, 0)->rgba[1], 200);
  EXPECT_EQ(image_of(scene, 1)->rgba[0], 200);
  const SceneDescription none = load(names, "", kNothing, face, {corners + "-1", "0 0"});
  EXPECT_EQ(image_of(none, 0), nullptr);
  EXPECT_EQ(image_of(none, 1), nullptr) << "no coordinates";
  const SceneDescription gone = load("comment TextureFile a.png\ncomment TextureFile b.png\n", "",
                                     kNothing, face, {corners + "1", corners + "9"});
  EXPECT_EQ(gone.materials.size(), 1u);
}

TEST_F(PlyLook, ShowsColoursOfFaces) {
  const auto face = [](const std::string& type) {
    return "property " + type + " red\nproperty " + type + " green\nproperty " + type + " blue\n";
  };
  const SceneDescription bytes = load("", "", kNothing, face("uchar") + "property uchar alpha\n",
                                      {"255 0 128 255", "0 255 0 255"});
  EXPECT_TRUE(bytes.warnings.empty());
  const SceneDescription floats = load("", "", kNothing, face("float"), {"1 0 0.2158605", "0 1 0"});
  const SceneDescription wide = load("", "", kNothing, face("float"), {"255 0 128", "0 255 0"});
  EXPECT_TRUE(warns(wide, "divided by 255"));
  for (const SceneDescription* scene : {&bytes, &floats, &wide}) {
    for (std::size_t k = 0; k < 3; ++k) {
      expect_color(color_of(*scene, 0, k), {1, 0, kHalf});
      expect_color(color_of(*scene, 1, k), {0, 1, 0});
    }
    EXPECT_EQ(scene->meshes[0].positions.size(), 6u);
    for (const Vec3& normal : scene->meshes[0].normals) EXPECT_EQ(normal.z, 1);
  }
  const SceneDescription both = load("", face("uchar"), {"9 9 9", "9 9 9", "9 9 9", "9 9 9"},
                                     face("uchar"), {"255 0 0", "0 255 0"});
  EXPECT_TRUE(warns(both, "colours of vertices are used"));
  EXPECT_EQ(both.meshes[0].positions.size(), 4u);
}

TEST_F(PlyLook, TakesFloatColoursBeyondOneForBytes) {
  const std::string colors = "property float red\nproperty float green\nproperty float blue\n";
  const SceneDescription bytes =
      load("", colors, {"255 0 0", "0 128 0", "0 0 255", "1 1 999"}, "", kNoEnds);
  EXPECT_EQ(bytes.warnings.size(), 1u);
  EXPECT_TRUE(warns(bytes, "divided by 255"));
  expect_color(color_of(bytes, 0, 0), {1, 0, 0});
  expect_color(color_of(bytes, 0, 1), {0, kHalf, 0});
  EXPECT_EQ(color_of(bytes, 1, 2).z, 1);
  const SceneDescription one =
      load("", colors, {"0 128 255", "0 128 255", "0 128 255", "0 128 255"}, "", kNoEnds);
  EXPECT_TRUE(one.meshes[0].colors.empty());
  expect_color(color_of(one, 0, 0), {0, kHalf, 1});
  const SceneDescription rounded =
      load("", colors, {"1.0000001 0 0", "0 0.5 0", "0 0 1", "0 0 nan"}, "", kNoEnds);
  EXPECT_TRUE(rounded.warnings.empty());
  EXPECT_EQ(color_of(rounded, 0, 0).x, 1);
  EXPECT_EQ(color_of(rounded, 0, 1).y, 0.5f);
}

TEST_F(PlyLook, LeavesOutColoursBesideTextures) {
  const SceneDescription scene =
      load("comment TextureFile red.png\n",
           "property float s\nproperty float t\nproperty uchar red\n"
           "property uchar green\nproperty uchar blue\n",
           {"0 0 9 9 9", "1 0 9 9 9", "1 1 9 9 9", "0 1 0 0 0"}, "", kNoEnds);
  EXPECT_TRUE(warns(scene, "a mesh with textures"));
  EXPECT_TRUE(scene.meshes[0].colors.empty());
  EXPECT_EQ(scene.materials[0].base_color.x, 1);
}

/// A binary file with a strip of `count` triangles, face colours and texture coordinates of
/// corners.
TEST_F(PlyLook, IsPackedAsItIsHeld) {
  for (const bool textured : {true, false}) {
    const std::uint32_t count = 200;
    std::string head = "ply\nformat binary_little_endian 1.0\n";
    if (textured) head += "comment TextureFile red.png\ncomment TextureFile green image.png\n";
    head += "element vertex " + std::to_string(count + 2) +
            "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
            std::to_string(count) +
            "\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\n"
            "property uchar texnumber\nproperty uchar red\nproperty uchar green\n"
            "property uchar blue\nend_header\n";
    Bytes bytes(head.begin(), head.end());
    for (std::uint32_t v = 0; v < count + 2; ++v)
      for (const std::uint32_t x : {v / 2, v % 2, v % 3}) append(bytes, static_cast<float>(x));
    for (std::uint32_t f = 0; f < count; ++f) {
      append(bytes, std::uint8_t{6});
      for (std::uint32_t k = 0; k < 6; ++k) append(bytes, 0.25f * static_cast<float>((f + k) % 5));
      append(bytes, std::uint8_t{3});
      for (std::uint32_t k = 0; k < 3; ++k) append(bytes, f + k);
      append(bytes, static_cast<std::uint8_t>(f % 2));
      for (const std::uint32_t c : {f, 2 * f, f / 3}) append(bytes, static_cast<std::uint8_t>(c));
    }
    const std::string file = write("a.ply", bytes);
    EXPECT_GT(load_scene(file).meshes[0].positions.size(), count);
    expect_same(file, 100, 10);
  }
}

TEST_F(PlyLook, SaysThatAFileHoldsPoints) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 2\n";
  const std::string place = "property float x\nproperty float y\nproperty float z\n";
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    expect_refused(write("a.ply", text), kInvalidData, words);
  };
  refused(head + place + "end_header\n0 0 0\n1 0 0\n", {"2 points and no faces"});
  refused(head + place +
              "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
              "0 0 0\n1 0 0\n",
          {"2 points and no faces"});
  refused(head + place +
              "property float f_dc_0\nproperty float scale_0\nproperty float rot_0\n"
              "end_header\n0 0 0 0 0 0\n0 0 0 0 0 0\n",
          {"2 Gaussian splats and no faces"});
  refused(
      head + "property uint packed_position\nproperty uint packed_scale\nend_header\n1 1\n1 1\n",
      {"Gaussian splats"});
}

}  // namespace
}  // namespace raysheaf::test
