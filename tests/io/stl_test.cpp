// STL, ASCII and binary.
#include <limits>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using enum ErrorCode;
using Stl = IoTest;

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\n"
    "endfacet\n";

Bytes binary(const std::string& head, std::uint32_t said, std::uint32_t there) {
  Bytes bytes(head.begin(), head.end());
  bytes.resize(80, ' ');
  append(bytes, said);
  for (std::uint32_t t = 0; t < there; ++t) {
    for (const float x : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) {
      append(bytes, x);
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST_F(Stl, ReadsAsciiWithAnyEndsOfLines) {
  const std::string text =
      "solid one two\n" + kFacet + kFacet + "endsolid one two\nSOLID\n" + kFacet + "endsolid\n";
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const SceneDescription scene = load_scene(write("a.stl", with_line_ends(text, end)));
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[0].name, "one two");
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
    EXPECT_EQ(scene.meshes[0].positions.size(), 6u) << "nothing is welded";
    EXPECT_TRUE(scene.meshes[0].normals.empty()) << "flat";
    EXPECT_TRUE(scene.materials[0].double_sided);
  }
}

TEST_F(Stl, ReadsBinaryEvenIfItSaysSolid) {
  for (const char* head : {"", "solid looks like text"}) {
    const SceneDescription scene = load_scene(write("a.stl", binary(head, 5, 5)));
    EXPECT_EQ(scene.triangle_count(), 5u);
    EXPECT_EQ(scene.meshes[0].positions[1].x, 1);
  }
  Bytes longer = binary("solid", 2, 2);
  longer.push_back(0);
  EXPECT_EQ(load_scene(write("b.stl", longer)).triangle_count(), 2u);
}

/// A binary file whose triangles have these attributes.
Bytes coloured(const std::string& head, const std::vector<std::uint16_t>& attributes) {
  const auto count = static_cast<std::uint32_t>(attributes.size());
  Bytes bytes = binary(head, count, count);
  for (std::size_t t = 0; t < attributes.size(); ++t)
    std::memcpy(bytes.data() + 84 + 50 * t + 48, &attributes[t], sizeof attributes[t]);
  return bytes;
}
/// "COLOR=" with an orange body, as Magics writes it.
const std::string kMagics = "COLOR=\xff\x80" + std::string(1, '\0') + "\xff";
constexpr float kLinear128 = 0.2158605f;

void expect_colors(const SceneDescription& scene, const std::vector<Vec3>& expected) {
  const Mesh& mesh = scene.meshes[0];
  const Vec4 base = scene.materials[0].base_color;
  for (std::size_t t = 0; t < expected.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 own = mesh.colors.empty() ? Vec3{1, 1, 1} : mesh.colors[mesh.triangles[t][k]];
      EXPECT_NEAR(own.x * base.x, expected[t].x, 1e-6) << t;
      EXPECT_NEAR(own.y * base.y, expected[t].y, 1e-6) << t;
      EXPECT_NEAR(own.z * base.z, expected[t].z, 1e-6) << t;
    }
  }
}

TEST_F(Stl, ShowsTheColoursOfMagics) {
  const Vec3 orange{1, kLinear128, 0};
  expect_colors(load_scene(write("a.stl", coloured(kMagics, {0x001f, 0x03e0, 0x7c00, 0xffff}))),
                {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, orange});
  for (const std::uint16_t none : {std::uint16_t{0}, std::uint16_t{0x8000}}) {
    const SceneDescription scene = load_scene(write("a.stl", coloured(kMagics, {none, none})));
    expect_colors(scene, {orange, orange});
    EXPECT_TRUE(scene.meshes[0].colors.empty()) << "one colour is the material's";
  }
  expect_colors(load_scene(write("a.stl", coloured(kMagics, {0, 0x001f}))), {{0, 0, 0}, {1, 0, 0}});
}

TEST_F(Stl, ShowsTheColoursOfViscam) {
  const Vec3 grey{0.8f, 0.8f, 0.8f};
  expect_colors(load_scene(write("a.stl", coloured("", {0x801f, 0xfc00, 0x03e0, 0x83e0}))),
                {{0, 0, 1}, {1, 0, 0}, grey, {0, 1, 0}});
  const SceneDescription red = load_scene(write("a.stl", coloured("", {0xfc00, 0xfc00})));
  expect_colors(red, {{1, 0, 0}, {1, 0, 0}});
  EXPECT_TRUE(red.meshes[0].colors.empty());
  expect_colors(load_scene(write("a.stl", coloured("", {7, 7}))), {grey, grey});
}

TEST_F(Stl, ReadsTextBehindAByteOrderMark) {
  const std::string text = "\xef\xbb\xbfsolid one\n" + kFacet + "endsolid\n";
  const SceneDescription scene = load_scene(write("a.stl", text));
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "one");
}

TEST_F(Stl, ReadsDialects) {
  std::string facet = kFacet;
  facet.replace(facet.find("endloop"), 7, "end  loop");
  facet.replace(facet.find("endfacet"), 8, "End Facet");
  const SceneDescription ends =
      load_scene(write("a.stl", "solid a\n" + facet + facet + "end solid a\n"));
  EXPECT_EQ(ends.triangle_count(), 2u);
  EXPECT_TRUE(ends.warnings.empty());
  for (const char* before : {"facet", " outer", "  vertex 1", " endloop", "endsolid"}) {
    std::string text = "solid a\n" + kFacet + "endsolid a\n";
    text.insert(text.find(before), "COLOR 0.5 0.5 1\n");
    const SceneDescription scene = load_scene(write("a.stl", text));
    EXPECT_EQ(scene.triangle_count(), 1u) << before;
    EXPECT_EQ(scene.warnings.size(), 1u) << before;
    EXPECT_TRUE(warns(scene, "color")) << before;
  }
}

TEST_F(Stl, NamesWhatIsWrong) {
  expect_refused(write("a.stl", binary("", 6, 5)), kInvalidData, {"6 triangles", "for 5"});
  expect_refused(write("a.stl", binary("", 0xffffffff, 1)), kInvalidData, {"truncated"});
  expect_refused(write("a.stl", binary("", 0, 0)), kInvalidData, {"triangle"});
  expect_refused(write("a.stl", Bytes(20, 1)), kInvalidData, {"header"});
  Bytes nan = binary("", 2, 2);
  const float bad = std::numeric_limits<float>::infinity();
  std::memcpy(nan.data() + 84 + 50 + 12, &bad, sizeof bad);
  EXPECT_TRUE(warns(load_scene(write("a.stl", nan)), "A face is left out"));
  EXPECT_EQ(load_scene(path("a.stl")).triangle_count(), 1u);
  expect_refused(write("a.stl", "solid\n" + kFacet), kInvalidData, {"truncated"});
  expect_refused(write("a.stl", "solid\n" + kFacet.substr(0, 60)), kInvalidData, {"line"});
  expect_refused(write("a.stl", std::string("solid\nfacet normal 0 0 1\nouter\nvertex")),
                 kInvalidData, {"line 4", "\"loop\""});
  std::string text = "solid\n" + kFacet + "endsolid\n";
  text.replace(text.find("1 0 0"), 5, "1 x 0");
  expect_refused(write("a.stl", text), kInvalidData, {"line 5", "\"x\""});
  for (const char* odd : {"1 nan 0", "1 1e99 0"}) {
    std::string one = "solid\n" + kFacet + "endsolid\n";
    one.replace(one.find("1 0 0"), 5, odd);
    expect_refused(write("a.stl", one), kInvalidData, {"every face", "not finite"});
    EXPECT_EQ(
        load_scene(write("a.stl", one + one + "solid\n" + kFacet + "endsolid\n")).triangle_count(),
        1u);
    EXPECT_TRUE(warns(load_scene(path("a.stl")), "2 faces are left out"));
  }
}

/// A file in which `size` bytes follow each triangle, as its attribute states.
Bytes with_data(std::uint32_t count, std::uint16_t size) {
  Bytes bytes = binary("", count, 0);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Bytes one = binary("", 1, 1);
    bytes.insert(bytes.end(), one.begin() + 84, one.end() - 2);
    append(bytes, size);
    bytes.resize(bytes.size() + size, 'x');
  }
  return bytes;
}

TEST_F(Stl, SkipsDataAfterTriangles) {
  for (const std::uint16_t size : std::initializer_list<std::uint16_t>{1, 4, 50, 40000}) {
    const SceneDescription scene = load_scene(write("a.stl", with_data(5, size)));
    EXPECT_EQ(scene.triangle_count(), 5u) << size;
    for (std::size_t v = 0; v < 15; v += 3)
      EXPECT_EQ(scene.meshes[0].positions[v + 1].x, 1) << size;
    EXPECT_TRUE(scene.meshes[0].colors.empty());
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(warns(scene, "Data after the triangles"));
  }
}

TEST_F(Stl, ReadsByTheSizeIfTheHeaderSaysLess) {
  for (const std::uint32_t said : {0u, 1u, 4u}) {
    const SceneDescription scene = load_scene(write("a.stl", binary("", said, 5)));
    EXPECT_EQ(scene.triangle_count(), 5u) << said;
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(warns(scene, "says that it has " + std::to_string(said) + " triangles"));
    EXPECT_TRUE(warns(scene, "bytes for 5"));
  }
  Bytes padded = binary("", 2, 2);
  padded.resize(padded.size() + 100);
  EXPECT_EQ(load_scene(write("a.stl", padded)).triangle_count(), 2u);
  EXPECT_TRUE(warns(load_scene(path("a.stl")), "100 bytes"));
}

TEST_F(Stl, ReadsTextThatDoesNotBeginWithSolid) {
  const std::string solid = "solid a\n" + kFacet + "endsolid a\n";
  const std::string zeros(90, '\0');
  for (const std::string& text :
       {"# a comment\n; another\n" + solid, kFacet + kFacet, kFacet + "endsolid\n", solid + zeros,
        solid + "\x1a", std::string("solid a") + zeros + "\n" + kFacet + "endsolid\n",
        "FACET" + kFacet.substr(5)}) {
    const SceneDescription scene = load_scene(write("a.stl", text));
    EXPECT_GE(scene.triangle_count(), 1u) << text;
    EXPECT_TRUE(scene.warnings.empty()) << text;
  }
  std::string commas = kFacet;
  commas.replace(commas.find("1 0 0"), 5, "1,5 0 0");
  EXPECT_EQ(load_scene(write("a.stl", commas)).meshes[0].positions[1].x, 1.5f);
  EXPECT_TRUE(warns(load_scene(path("a.stl")), "Commas"));
  for (const char* mark : {"\xff\xfe", ""}) {
    std::string wide = mark;
    for (const char c : solid) wide += c, wide += '\0';
    expect_refused(write("a.stl", wide), kUnsupported, {"UTF-16"});
  }
  expect_refused(write("a.stl", std::string(200, 'x')), kInvalidData, {"line 1", "solid"});
}

}  // namespace
}  // namespace raysheaf::test
