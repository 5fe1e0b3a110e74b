// PLY in its three formats.
#include <bit>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using enum ErrorCode;

class Ply : public IoTest {
 protected:
  SceneDescription load(const std::string& text) { return load_scene(write("a.ply", text)); }
  void expect(const std::string& text, const std::vector<std::string>& words) {
    expect_refused(write("a.ply", text), kInvalidData, words);
  }
};

const std::string kAscii = "ply\nformat ascii 1.0\n";
const std::string kPlySquare =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST_F(Ply, ReadsAsciiPolygons) {
  const SceneDescription scene = load(kAscii + "comment hello\nobj_info x\nCreated by a program\n" +
                                      kPlySquare + "4 0 1 2 3\n");
  ASSERT_EQ(scene.triangle_count(), 2u);
  ASSERT_EQ(scene.meshes[0].normals.size(), 4u);
  EXPECT_EQ(scene.meshes[0].normals[0].z, 1);
  EXPECT_TRUE(scene.materials[0].double_sided);
  EXPECT_EQ(scene.instances.size(), 1u);
}

/// Rhinoceros writes "\r" as the end of lines.
TEST_F(Ply, ReadsAnyEndsOfLines) {
  const std::string text = kAscii + kPlySquare + "4 0 1 2 3\n";
  std::string head = text.substr(0, text.find("0 0 0"));
  head.replace(head.find("ascii"), 5, "binary_little_endian");
  const float first = std::bit_cast<float>(0x3f800d0au);  // its lowest bytes are line ends
  Bytes body;
  for (const float x : {first, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f})
    append(body, x);
  append(body, std::uint8_t{3});
  for (const std::int32_t v : {0, 1, 2}) append(body, v);
  for (const char* end : {"\n", "\r\n", "\r"}) {
    EXPECT_EQ(load(with_line_ends(text, end)).triangle_count(), 2u);
    const SceneDescription scene =
        load(with_line_ends(head, end) + std::string(body.begin(), body.end()));
    ASSERT_EQ(scene.triangle_count(), 1u);
    EXPECT_EQ(scene.meshes[0].positions[0].x, first);
  }
}

/// The same file in both byte orders, with unusual types and unknown properties, lists and
/// elements.
TEST_F(Ply, ReadsBinaryOfEitherByteOrder) {
  for (const bool little : {true, false}) {
    const std::string head =
        std::string("ply\nformat binary_") + (little ? "little" : "big") +
        "_endian 1.0\nelement camera 2\nproperty double view\nproperty list short uchar bytes\n"
        "element vertex 3\nproperty ushort flags\nproperty double x\nproperty float32 y\n"
        "property int16 z\nproperty list uint8 float64 weights\nproperty float nx\n"
        "property float ny\nproperty float nz\n"
        "element face 1\nproperty uint8 kind\nproperty list uint16 uint32 vertex_index\n"
        "property float quality\nend_header\n";
    Bytes body;
    const auto put = [&](auto value) {
      little ? append(body, value) : append_swapped(body, value);
    };
    for (int i = 0; i < 2; ++i) {
      put(1.5), put(std::int16_t{3}), put(std::uint8_t{1}), put(std::uint8_t{2});
      put(std::uint8_t{3});
    }
    for (int v = 0; v < 3; ++v) {
      put(std::uint16_t{7}), put(v == 1 ? 2.0 : 0.0), put(v == 2 ? 3.0f : 0.0f);
      put(std::int16_t{-4}), put(static_cast<std::uint8_t>(v));
      for (int w = 0; w < v; ++w) put(0.5);
      put(0.0f), put(0.0f), put(-2.0f);
    }
    put(std::uint8_t{1}), put(std::uint16_t{3});
    put(std::uint32_t{2}), put(std::uint32_t{1}), put(std::uint32_t{0}), put(1.0f);
    const SceneDescription scene = load(head + std::string(body.begin(), body.end()));
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.triangles.size(), 1u);
    const std::array<std::uint32_t, 3> expected = {2, 1, 0};
    EXPECT_EQ(mesh.triangles[0], expected);
    EXPECT_EQ(mesh.positions[1].x, 2);
    EXPECT_EQ(mesh.positions[2].y, 3);
    EXPECT_EQ(mesh.positions[0].z, -4);
    EXPECT_EQ(mesh.normals[0].z, -1);
    EXPECT_TRUE(warns(scene, "\"camera\""));
  }
}

TEST_F(Ply, ReadsTriangleStripsWithRestarts) {
  const SceneDescription scene =
      load(kAscii +
           "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
           "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n");
  const std::vector<std::array<std::uint32_t, 3>> expected = {{0, 1, 2}, {1, 3, 2}, {0, 1, 3}};
  EXPECT_EQ(scene.meshes[0].triangles, expected);
}

TEST_F(Ply, TakesTheColourThatAllVerticesHave) {
  const std::string head =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const SceneDescription same =
      load(kAscii + head + "0 0 0 255 0 128\n1 0 0 255 0 128\n0 1 0 255 0 128\n3 0 1 2\n");
  EXPECT_EQ(same.materials[0].base_color.x, 1);
  EXPECT_NEAR(same.materials[0].base_color.z, 0.2158605f, 1e-5) << "sRGB";
  EXPECT_TRUE(same.warnings.empty());
  const SceneDescription other =
      load(kAscii + head + "0 0 0 255 0 128\n1 0 0 255 0 128\n0 1 0 254 0 128\n3 0 1 2\n");
  EXPECT_EQ(other.materials[0].base_color.z, 1) << "and the colours next to it";
  ASSERT_EQ(other.meshes[0].colors.size(), 3u);
  EXPECT_EQ(other.meshes[0].colors[0].x, 1);
  EXPECT_EQ(other.meshes[0].colors[1].y, 0);
  EXPECT_NEAR(other.meshes[0].colors[2].x, 0.9911021f, 1e-5) << "sRGB";
  EXPECT_TRUE(other.warnings.empty());
}

TEST_F(Ply, ReadsColoursOfEveryWidth) {
  struct Width {
    const char *type, *color;
  };
  for (const Width& width :
       {Width{"uchar", "255 0 128"}, Width{"ushort", "65535 0 32896"}, Width{"int", "255 0 128"},
        Width{"uint16", "99999 -1 32896"}, Width{"float", "1 0 0.2158605"}}) {
    std::string text =
        kAscii + "element vertex 3\nproperty float x\nproperty float y\n" + "property float z\n";
    for (const char* name : {"red", "green", "blue"})
      text += std::string("property ") + width.type + " " + name + "\n";
    text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (const char* position : {"0 0 0 ", "1 0 0 ", "0 1 0 "})
      text += std::string(position) + width.color + "\n";
    const Vec4 color = load(text + "3 0 1 2\n").materials[0].base_color;
    EXPECT_EQ(color.x, 1) << width.type;
    EXPECT_EQ(color.y, 0) << width.type;
    EXPECT_NEAR(color.z, 0.2158605f, 1e-6) << width.type;
  }
}

TEST_F(Ply, WarnsOfAlphaBelowOne) {
  struct Kind {
    const char *type, *whole, *less;
  };
  for (const Kind& kind :
       {Kind{"uchar", "255", "254"}, Kind{"ushort", "65535", "65534"}, Kind{"float", "1", "0.5"}}) {
    const auto scene_with = [&](const std::string& alpha) {
      return load(kAscii + "element vertex 3\nproperty float x\nproperty " + kind.type +
                  " alpha\nproperty float y\nproperty float z\n" +
                  "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + "0 " +
                  kind.whole + " 0 0\n1 " + alpha + " 0 0\n0 " + kind.whole + " 1 0\n3 0 1 2\n");
    };
    EXPECT_TRUE(scene_with(kind.whole).warnings.empty()) << kind.type;
    EXPECT_TRUE(warns(scene_with(kind.less), "alpha")) << kind.type;
    EXPECT_EQ(scene_with(kind.less).meshes[0].positions[2].y, 1) << kind.type;
  }
}

TEST_F(Ply, LeavesOutFacesWithVerticesThatAreNotFinite) {
  for (const char* odd : {"nan 0 0", "0 -inf 0", "1.#INF 0 0", "1e999 0 0"}) {
    const auto text = [&](const std::string& faces, int count) {
      return kAscii +
             "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
             "element face " +
             std::to_string(count) + "\nproperty list uchar int vertex_index\nend_header\n" + odd +
             "\n5 0 0\n6 0 0\n6 1 0\n5 1 0\n" + faces;
    };
    const SceneDescription unused = load_scene(write("a.ply", text("4 1 2 3 4\n", 1)));
    EXPECT_EQ(unused.triangle_count(), 2u) << odd;
    EXPECT_TRUE(unused.warnings.empty()) << odd;
    EXPECT_EQ(world_bounds(unused).min.x, 5) << odd;
    const SceneDescription used =
        load_scene(write("a.ply", text("3 0 1 2\n3 1 2 3\n4 1 2 3 0\n", 3)));
    EXPECT_EQ(used.triangle_count(), 1u) << odd;
    EXPECT_TRUE(warns(used, "2 faces")) << odd;
    expect(text("3 0 1 2\n", 1), {"every face", "not finite"});
  }
}

TEST_F(Ply, NamesTheElementThatIsWrong) {
  expect(kAscii + kPlySquare + "4 0 1 2 4\n", {"face[0].vertex_indices[3]", "4 vertices"});
  expect(kAscii + kPlySquare + "3 0 1 -1\n", {"face[0].vertex_indices[2]"});
  expect(kAscii + kPlySquare + "3 0 1\n", {"face[0]", "truncated"});
  expect(kAscii + kPlySquare + "9999999 0 1\n", {"face[0]", "count"});
  expect(kAscii + kPlySquare + "-1 0 1\n", {"face[0]", "count"});
  expect(kAscii + kPlySquare + "3 0 1 x\n", {"face[0]", "\"x\""});
  expect(kAscii + "element vertex 99999999999\nproperty float x\nend_header\n0\n",
         {"element vertex", "99999999999"});
  expect(kAscii + "element nothing 99999999999\nend_header\n0\n", {"element nothing"});
  expect(kAscii + "element vertex 1\nproperty float x\nend_header\n0\n", {"x, y and z"});
  expect(kAscii + "element vertex -1\nend_header\n", {"line 3"});
  expect(kAscii + "element vertex 1\nproperty quad x\nend_header\n", {"line 4", "\"quad\""});
  expect(kAscii + "property float x\nend_header\n", {"line 3"});
  expect(kAscii + "element vertex 1\n", {"end_header"});
  expect("ply\nelement vertex 1\nproperty float x\nend_header\n1\n", {"format"});
  expect("ply\nformat binary_middle_endian 1.0\nend_header\n", {"line 2", "binary_middle_endian"});
  expect("plyx\n", {"line 1"});
  expect(kAscii + "end_header\n", {"triangle"});
  expect(kAscii +
             "element face 1\nproperty list uchar int vertex_index\nelement vertex 3\n"
             "property float x\nproperty float y\nproperty float z\nend_header\n"
             "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n",
         {"element face", "no vertices before it"});
}

}  // namespace
}  // namespace raysheaf::test
