// EXR images as textures, and images that cannot be read.
#include <cmath>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using namespace std::string_literals;

class ExrTexture : public IoTest {
 protected:
  /// A scene whose material has this line.
  SceneDescription load(const std::string& line) {
    write("a.mtl", "newmtl m\n" + line + "\n");
    return load_scene(write("a.obj",
                            "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\n"
                            "f 1/1 2/1 3/1\n"s));
  }
  std::vector<std::uint8_t> texels(const std::string& line) {
    const SceneDescription scene = load(line);
    return scene.images.size() == 1 ? scene.images[0].rgba : std::vector<std::uint8_t>{};
  }
};

using Texels = std::vector<std::uint8_t>;

TEST_F(ExrTexture, HasLinearColours) {
  write_exr(2, 1, {{"R", {1, 0.2158605f}}, {"G", {0, 0.5f}}, {"B", {-1, NAN}}}, path("t.exr"));
  EXPECT_EQ(texels("map_Kd t.exr"), (Texels{255, 0, 0, 255, 128, 188, 0, 255}));
  EXPECT_TRUE(load("map_Kd t.exr").warnings.empty());
  EXPECT_EQ(texels("norm t.exr"), (Texels{255, 0, 0, 255, 55, 128, 0, 255})) << "numbers";
}

TEST_F(ExrTexture, MayBeRaysheafsOwn) {
  write_exr(1, 1,
            {{"R", {1}},
             {"G", {0}},
             {"B", {1}},
             {"albedo.R", {0}},
             {"normal.X", {0.5f}},
             {"position.Z", {7}},
             {"Z", {3}}},
            path("t.exr"));
  EXPECT_EQ(texels("map_Kd t.exr"), (Texels{255, 0, 255, 255}));
}

TEST_F(ExrTexture, IsNotPremultiplied) {
  write_exr(1, 1, {{"R", {0.5f}}, {"G", {0.25f}}, {"B", {0}}, {"A", {0.5f}}}, path("t.exr"));
  EXPECT_EQ(texels("map_Kd t.exr"), (Texels{255, 188, 0, 128}));
}

TEST_F(ExrTexture, MayBeGreyAndBrighterThanWhite) {
  write_exr(1, 1, {{"Y", {9}}}, path("t.exr"));
  const SceneDescription scene = load("map_Kd t.exr");
  ASSERT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.images[0].rgba, (Texels{255, 255, 255, 255}));
  EXPECT_TRUE(warns(scene, "numbers above 1"));
  write_exr(1, 1, {{"Y", {0.5f}}}, path("t.exr"));
  EXPECT_EQ(texels("map_Kd t.exr"), (Texels{188, 188, 188, 255}));
}

TEST_F(ExrTexture, WithOtherChannelsIsLeftOut) {
  write_exr(1, 1, {{"Y", {1}}, {"Z", {2}}}, path("t.exr"));
  EXPECT_TRUE(load("map_Kd t.exr").images.empty());
}

TEST_F(ExrTexture, TruncatedIsLeftOut) {
  write_exr(16, 16, {{"R", std::vector<float>(256, 1)}}, path("whole.exr"));
  const std::string whole = read("whole.exr");
  for (const std::size_t length : {5u, 40u, 200u}) {
    write("t.exr", whole.substr(0, length));
    const SceneDescription scene = load("map_Kd t.exr");
    EXPECT_TRUE(scene.images.empty()) << length;
    EXPECT_TRUE(warns(scene, "truncated")) << length;
  }
}

TEST_F(ExrTexture, OtherFormatsOfItsKindAreNamed) {
  struct Case {
    std::string bytes;
    const char* words;
  };
  for (const Case& one :
       {Case{"II*\0\x8\0\0\0"s, "is a TIFF image"}, Case{"MM\0*\0\0\0\x8"s, "is a TIFF image"},
        Case{"GIF89a\1\0\1\0"s, "is a GIF image"}, Case{"8BPS\0\1"s, "is a Photoshop image"},
        Case{"DDS \x7c\0\0\0"s, "is a DDS texture"},
        Case{"\xabKTX 20\xbb\r\n\x1a\n"s, "is a KTX texture"},
        Case{"#?RADIANCE\n"s, "is a Radiance HDR image"},
        Case{"<svg xmlns=\"\">"s, "is an SVG image"}}) {
    write("t.img", one.bytes);
    const SceneDescription scene = load("map_Kd t.img");
    EXPECT_TRUE(warns(scene, one.words)) << one.words;
    EXPECT_TRUE(warns(scene, "PNG, JPEG, WebP and EXR are read")) << one.words;
    EXPECT_EQ(scene.warnings.size(), 1u);
  }
  write("t.img", "nothing at all"s);
  EXPECT_TRUE(warns(load("map_Kd t.img"), "not an image"));
}

}  // namespace
}  // namespace raysheaf::test
