// WebP images as cwebp wrote them, complete and truncated; and glTF textures that use them.
#include "io/image_formats.h"

#include "raysheaf/io.h"
#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;

/// 2 x 2, lossless: red, green (alpha 128), blue, (10, 20, 30) with alpha 0.
const Bytes kLosslessWebp = {0x52, 0x49, 0x46, 0x46, 0x3a, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42,
                             0x50, 0x56, 0x50, 0x38, 0x4c, 0x2e, 0x00, 0x00, 0x00, 0x2f, 0x01,
                             0x40, 0x00, 0x10, 0x1f, 0x20, 0x10, 0x48, 0x92, 0xd8, 0x1f, 0x75,
                             0x0d, 0x21, 0x01, 0x41, 0xf5, 0xff, 0x2f, 0x81, 0x00, 0xc1, 0x88,
                             0xff, 0x4b, 0x02, 0x01, 0x42, 0x3a, 0xe5, 0x02, 0x6f, 0x59, 0xaa,
                             0x84, 0x92, 0x00, 0x01, 0x50, 0x94, 0x91, 0x88, 0xfe, 0x07, 0x03};
/// 16 x 16, lossy: red increases by 16 per pixel to the right, green by 16 downwards, blue is 128.
const Bytes kLossyWebp = {
    0x52, 0x49, 0x46, 0x46, 0x62, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x20,
    0x56, 0x00, 0x00, 0x00, 0xd0, 0x02, 0x00, 0x9d, 0x01, 0x2a, 0x10, 0x00, 0x10, 0x00, 0x00, 0xc0,
    0x12, 0x25, 0xb0, 0x02, 0x74, 0x73, 0x01, 0x72, 0x81, 0xbc, 0x00, 0xaf, 0x00, 0x13, 0x77, 0x2d,
    0xb9, 0x5a, 0xe8, 0x00, 0xfe, 0xff, 0xab, 0xcc, 0xfd, 0x7c, 0x41, 0x4e, 0xe0, 0x59, 0x77, 0x83,
    0xaa, 0x58, 0x88, 0x68, 0x3c, 0x0f, 0x05, 0xbb, 0xff, 0xf6, 0x5d, 0x63, 0x1f, 0xe4, 0x2e, 0xbb,
    0x4d, 0xd8, 0x1f, 0x74, 0x5c, 0x17, 0xbf, 0xca, 0x05, 0xdf, 0xff, 0x97, 0x1a, 0x50, 0x2e, 0xff,
    0xfc, 0xdb, 0xf2, 0x81, 0x2e, 0x95, 0xf3, 0x60, 0x00, 0x00};

class Webp : public IoTest {
 protected:
  void SetUp() override {
    IoTest::SetUp();
    if (!io::reads_webp()) GTEST_SKIP() << "this build has no libwebp";
  }
};

TEST_F(Webp, ReadsBothKinds) {
  const auto exact = io::decode_image(kLosslessWebp);
  ASSERT_TRUE(exact);
  const std::vector<std::uint8_t> expected = {255, 0, 0,   255, 0,  255, 0,  128,
                                              0,   0, 255, 255, 10, 20,  30, 0};
  EXPECT_EQ(exact->width, 2u);
  EXPECT_EQ(exact->rgba, expected);
  const auto lossy = io::decode_image(kLossyWebp);
  ASSERT_TRUE(lossy);
  ASSERT_EQ(lossy->rgba.size(), 1024u);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const std::uint8_t* const pixel = lossy->rgba.data() + 4 * (16 * y + x);
      EXPECT_NEAR(pixel[0], 16 * x, 24);
      EXPECT_NEAR(pixel[1], 16 * y, 24);
      EXPECT_NEAR(pixel[2], 128, 24);
      EXPECT_EQ(pixel[3], 255);
    }
  }
}

TEST_F(Webp, RefusesTruncatedOrDamagedFiles) {
  for (const Bytes& whole : {kLosslessWebp, kLossyWebp}) {
    for (std::size_t size = 0; size < whole.size() - 1; ++size)  // the last byte may be padding
      EXPECT_FALSE(io::decode_image({whole.data(), size})) << size;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      Bytes damaged = whole;
      damaged[at] ^= 0xff;
      static_cast<void>(io::decode_image(damaged));  // any result is fine, but it must return
    }
  }
}

TEST_F(Webp, TexturesMayNameAWebpAndAFallback) {
  GltfFile file;
  file.show_triangle();
  file.json["extensionsRequired"] = file.json["extensionsUsed"] = {"EXT_texture_webp"};
  write_png({"small", 1, 1, {9, 9, 9, 255}}, path("a.png"));
  file.add("images", {{"uri", "a.png"}});
  file.add("images", {{"bufferView", file.view(kLosslessWebp)}, {"mimeType", "image/webp"}});
  const json extension = {{"EXT_texture_webp", {{"source", 1}}}};
  file.add("textures", {{"extensions", extension}});
  file.add("textures", {{"source", 0}, {"extensions", extension}});
  file.add("textures", {{"source", 0}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.textures.size(), 3u);
  EXPECT_EQ(scene.images[scene.textures[0].image].width, 2u);
  EXPECT_EQ(scene.images[scene.textures[1].image].width, 2u);
  EXPECT_EQ(scene.images[scene.textures[2].image].width, 1u);

  file.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 2;
  expect_refused(write("b.gltf", file.text()), ErrorCode::kInvalidData,
                 {"textures[0].extensions.EXT_texture_webp.source", "is 2"});
}

// Each frame of an animation is an image that decodes by itself once it has a head of its own.
TEST_F(Webp, AnimationsHoldTheirFrames) {
  constexpr std::uint32_t kWidth = 20, kHeight = 12;
  const auto frame = [&](std::uint8_t red, std::uint8_t alpha) {
    Image image;
    image.width = kWidth;
    image.height = kHeight;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i)
      image.rgba.insert(image.rgba.end(), {red, 100, 50, alpha});
    return image;
  };
  AnimatedWebp film(kWidth, kHeight, 30);
  film.add(frame(10, 255));
  film.add(frame(240, 255));
  film.add(frame(120, 0));
  EXPECT_THROW(film.add(Image{}), Error);
  EXPECT_THROW(AnimatedWebp(0, 1, 30), Error);
  EXPECT_THROW(AnimatedWebp(16384, 1, 30), Error);
  EXPECT_THROW(AnimatedWebp(1, 1, 0), Error);
  film.write(path("film.webp"));
  const Bytes file = io::read_file(path("film.webp"));
  EXPECT_EQ(file[20] & 0x12, 0x12);  // animated, with alpha
  std::vector<Image> seen;
  const auto size_at = [&](std::size_t at) {
    return std::size_t{file[at]} | std::size_t{file[at + 1]} << 8 | std::size_t{file[at + 2]} << 16;
  };
  for (std::size_t at = 12; at < file.size(); at += 8 + size_at(at + 4)) {
    if (file[at] != 'A' || file[at + 3] != 'F') continue;
    const auto first = file.begin() + static_cast<std::ptrdiff_t>(at + 24);
    Bytes chunks(first, file.begin() + static_cast<std::ptrdiff_t>(at + 8 + size_at(at + 4)));
    const bool has_alpha = chunks[0] == 'A';
    if (has_alpha) {
      seen.emplace_back();  // a single image would need VP8X, too
      continue;
    }
    const auto bytes = static_cast<std::uint32_t>(chunks.size() + 4);
    Bytes image = {'R', 'I', 'F', 'F'};
    for (int i = 0; i < 4; ++i) image.push_back(static_cast<std::uint8_t>(bytes >> (8 * i)));
    image.insert(image.end(), {'W', 'E', 'B', 'P'});
    image.insert(image.end(), chunks.begin(), chunks.end());
    const auto size = io::webp_size(image);
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, kWidth);
    const auto decoded = io::decode_webp(image, *size);
    ASSERT_TRUE(decoded);
    seen.push_back(*decoded);
  }
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_NEAR(seen[0].rgba[0], 10, 6);
  EXPECT_NEAR(seen[1].rgba[0], 240, 6);
}

}  // namespace
}  // namespace raysheaf::test
