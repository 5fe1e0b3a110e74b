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
TEST_F(Stl, NamesWhatIsWrong) {
  expect_refused(write("a.stl", binary("", 6, 5)), kInvalidData, {"6 triangles", "for 5"});
  expect_refused(write("a.stl", binary("", 0xffffffff, 1)), kInvalidData, {"truncated"});
  expect_refused(write("a.stl", binary("", 0, 0)), kInvalidData, {"triangle"});
  expect_refused(write("a.stl", Bytes(20, 1)), kInvalidData, {"header"});
  Bytes nan = binary("", 2, 2);
  const float bad = std::numeric_limits<float>::infinity();
  std::memcpy(nan.data() + 84 + 50 + 12, &bad, sizeof bad);
  expect_refused(write("a.stl", nan), kInvalidData, {"triangle[1]", "not finite"});
  expect_refused(write("a.stl", "solid\n" + kFacet), kInvalidData, {"truncated"});
  expect_refused(write("a.stl", "solid\n" + kFacet.substr(0, 60)), kInvalidData, {"line"});
  expect_refused(write("a.stl", std::string("solid\nfacet normal 0 0 1\nouter\nvertex")),
                 kInvalidData, {"line 4", "\"loop\""});
  std::string text = "solid\n" + kFacet + "endsolid\n";
  text.replace(text.find("1 0 0"), 5, "1 x 0");
  expect_refused(write("a.stl", text), kInvalidData, {"line 5", "\"x\""});
  text.replace(text.find("1 x 0"), 5, "1 nan 0");
  expect_refused(write("a.stl", text), kInvalidData, {"line 5", "not finite"});
  text.replace(text.find("1 nan 0"), 7, "1 1e99 0");
  for (const char* end : {"\n", "\r\n", "\r"})
    expect_refused(write("a.stl", with_line_ends(text, end)), kInvalidData,
                   {"line 5", "not finite"});
}

}  // namespace
}  // namespace raysheaf::test
