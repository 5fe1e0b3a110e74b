// EXR images as textures, and images that cannot be read.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <half.h>

#include <cmath>
#include <limits>

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
  const SceneDescription scene = load("map_Kd t.exr");
  EXPECT_TRUE(scene.images.empty());
  EXPECT_TRUE(warns(scene, "\"t.exr\" has the channels Y, Z, but R, G and B are read"));
}

TEST_F(ExrTexture, MayBeALayer) {
  write_exr(1, 1, {{"diffuse.R", {1}}, {"diffuse.G", {0}}, {"diffuse.B", {1}}, {"Z", {3}}},
            path("t.exr"));
  EXPECT_EQ(texels("map_Kd t.exr"), (Texels{255, 0, 255, 255}));
  EXPECT_TRUE(load("map_Kd t.exr").warnings.empty());
  write_exr(1, 1,
            {{"a.x.R", {1}},
             {"a.x.G", {0}},
             {"a.x.B", {0}},
             {"b.R", {0}},
             {"b.G", {1}},
             {"b.B", {1}},
             {"a.x.A", {0}}},
            path("t.exr"));
  const SceneDescription scene = load("map_Kd t.exr");
  EXPECT_EQ(texels("map_Kd t.exr"), (Texels{255, 0, 0, 0}));
  EXPECT_TRUE(warns(scene, "has 2 layers with colours; \"a.x\" is read"));
  write_exr(1, 1, {{"Y", {1}}, {"A", {0.5f}}}, path("t.exr"));
  EXPECT_EQ(texels("map_Kd t.exr"), (Texels{255, 255, 255, 128})) << "grey with alpha";
}

/// A file that OpenEXR writes: 40x24 pixels, red 0.25, green 0.5, blue 1, of half floats.
void write_half(const std::string& path, Imf::Compression compression, bool tiled) {
  constexpr int kWidth = 40, kHeight = 24;
  Imf::Header header(kWidth, kHeight);
  header.compression() = compression;
  std::vector<Imath::half> planes[3];
  Imf::FrameBuffer all;
  const char* const names[] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    planes[c].assign(kWidth * kHeight, Imath::half(0.25f * static_cast<float>(1 << c)));
    header.channels().insert(names[c], Imf::Channel(Imf::HALF));
    all.insert(names[c], Imf::Slice::Make(Imf::HALF, planes[c].data(), header.dataWindow()));
  }
  if (!tiled) {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(all);
    file.writePixels(kHeight);
    return;
  }
  header.setTileDescription(Imf::TileDescription(16, 16));
  Imf::TiledOutputFile file(path.c_str(), header);
  file.setFrameBuffer(all);
  file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
}

TEST_F(ExrTexture, MayHaveAnyCompression) {
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    for (const bool tiled : {false, true}) {
      write_half(path("t.exr"), static_cast<Imf::Compression>(compression), tiled);
      const SceneDescription scene = load("map_Kd t.exr");
      ASSERT_EQ(scene.images.size(), 1u) << compression << ": " << scene.warnings.at(0);
      EXPECT_EQ(scene.images[0].width, 40u);
      for (std::size_t i = 0; i < scene.images[0].rgba.size(); i += 4) {
        EXPECT_NEAR(scene.images[0].rgba[i], 137, 1) << compression;
        EXPECT_NEAR(scene.images[0].rgba[i + 1], 188, 1) << compression;
        EXPECT_NEAR(scene.images[0].rgba[i + 2], 255, 1) << compression;
      }
    }
  }
}

/// tinyexr ended the program in some of these cases.
TEST_F(ExrTexture, ChangedHeadersAreReadOrLeftOutWithAReason) {
  for (const bool tiled : {false, true}) {
    write_half(path("whole.exr"), Imf::ZIP_COMPRESSION, tiled);
    const std::string whole = read("whole.exr");
    const auto expect_reason = [&](const std::string& file) {
      write("t.exr", file);
      const SceneDescription scene = load("map_Kd t.exr");
      if (scene.images.empty()) {
        EXPECT_EQ(scene.warnings.size(), 1u);
        EXPECT_TRUE(warns(scene, "The image \"t.exr\" "));
      }
    };
    for (std::size_t at = 4; at < std::min<std::size_t>(whole.size(), 420); ++at) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] ^ 2);
      expect_reason(changed);
      expect_reason(whole.substr(0, at));
    }
  }
}

/// Red is the column of the data window and green the row, counted from 1.
void write_windows(const std::string& path, const Imath::Box2i& display, const Imath::Box2i& data,
                   bool has_alpha) {
  const int width = data.max.x - data.min.x + 1, height = data.max.y - data.min.y + 1;
  std::vector<float> red, green;
  for (int y = 1; y <= height; ++y) {
    for (int x = 1; x <= width; ++x) {
      red.push_back(static_cast<float>(x));
      green.push_back(static_cast<float>(y));
    }
  }
  const std::vector<float> one(red.size(), 1);
  Imf::Header header(display, data);
  Imf::FrameBuffer planes;
  const auto add = [&](const char* name, const std::vector<float>& values) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    planes.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), data, sizeof(float),
                                         sizeof(float) * static_cast<std::size_t>(width)));
  };
  add("R", red);
  add("G", green);
  add("B", one);
  if (has_alpha) add("A", one);
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(planes);
  file.writePixels(height);
}

TEST_F(ExrTexture, IsTheDisplayWindow) {
  struct Windows {
    Imath::Box2i display, data;
  };
  for (const Windows& one : {Windows{{{0, 0}, {4, 3}}, {{0, 0}, {4, 3}}},
                             Windows{{{0, 0}, {7, 5}}, {{2, 1}, {4, 3}}},      // less is stored
                             Windows{{{0, 0}, {3, 2}}, {{-2, -3}, {6, 7}}},    // more is stored
                             Windows{{{-5, -4}, {1, 1}}, {{-7, 0}, {-3, 9}}},  // they overlap
                             Windows{{{0, 0}, {2, 2}}, {{3, 0}, {5, 2}}},      // they are disjoint
                             Windows{{{100, 200}, {103, 201}}, {{101, 200}, {101, 200}}}}) {
    for (const bool has_alpha : {false, true}) {
      write_windows(path("t.exr"), one.display, one.data, has_alpha);
      const Environment map = load_environment(path("t.exr"));
      const SceneDescription scene = load("map_Kd t.exr");
      ASSERT_EQ(scene.images.size(), 1u);
      const int width = one.display.max.x - one.display.min.x + 1;
      const int height = one.display.max.y - one.display.min.y + 1;
      ASSERT_EQ(map.width, static_cast<std::uint32_t>(width));
      ASSERT_EQ(map.height, static_cast<std::uint32_t>(height));
      ASSERT_EQ(scene.images[0].width, map.width);
      ASSERT_EQ(scene.images[0].height, map.height);
      std::size_t at = 0;
      for (int y = one.display.min.y; y <= one.display.max.y; ++y) {
        for (int x = one.display.min.x; x <= one.display.max.x; ++x, ++at) {
          const bool is_stored = one.data.intersects(Imath::V2i(x, y));
          const Vec3 expected = is_stored ? Vec3{static_cast<float>(x - one.data.min.x + 1),
                                                 static_cast<float>(y - one.data.min.y + 1), 1}
                                          : Vec3{0, 0, 0};
          EXPECT_EQ(map.radiance[at], expected) << x << " " << y;
          EXPECT_EQ(scene.images[0].rgba[4 * at], is_stored ? 255 : 0);
          EXPECT_EQ(scene.images[0].rgba[4 * at + 3], is_stored ? 255 : 0);
        }
      }
    }
  }
}

TEST_F(ExrTexture, WithAHugeDisplayWindowIsLeftOut) {
  for (const int last : {1 << 15, std::numeric_limits<int>::max() / 2 - 1}) {
    write_windows(path("t.exr"), {{-last, -last}, {last, last}}, {{0, 0}, {3, 3}}, false);
    const SceneDescription scene = load("map_Kd t.exr");
    EXPECT_TRUE(scene.images.empty());
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(warns(scene, "The image \"t.exr\" "));
    EXPECT_THROW(static_cast<void>(load_environment(path("t.exr"))), Error);
  }
}

/// OpenEXR would allocate a block of sixteen rows, a gigabyte.
TEST_F(ExrTexture, WithHugeBlocksIsLeftOut) {
  constexpr std::uint32_t kWide = 1 << 22;
  write_exr(kWide, 1, {{"R", std::vector<float>(kWide)}}, path("t.exr"));
  std::string file = read("t.exr");
  const std::string name = "compression\0compression\0\1\0\0\0"s;
  const std::size_t at = file.find(name);
  ASSERT_NE(at, std::string::npos);
  file[at + name.size()] = Imf::DWAB_COMPRESSION;
  write("t.exr", file);
  const SceneDescription scene = load("map_Kd t.exr");
  EXPECT_TRUE(scene.images.empty());
  EXPECT_TRUE(warns(scene, "which is too large"));
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
