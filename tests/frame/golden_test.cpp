// Compares the built-in scenes with their reviewed images (tests/golden/*.png).
//
// Tolerance: at most half a percent of the pixels may differ by more than 6 of 255 in any channel,
// because drivers may rasterise silhouettes differently. RAYSHEAF_UPDATE_GOLDEN=1 writes the images
// again: look at them before committing them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/render.h"
#include "support/read_png.h"

namespace raysheaf {
namespace {

constexpr int kChannelTolerance = 6;

std::string golden_path(const std::string& name) {
  return std::string(RAYSHEAF_SOURCE_DIR) + "/tests/golden/" + name + ".png";
}

std::size_t different_pixels(const Image& a, const Image& b) {
  std::size_t count = 0;
  for (std::size_t pixel = 0; pixel < a.rgba.size(); pixel += 4) {
    int worst = 0;
    for (std::size_t c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(a.rgba[pixel + c] - b.rgba[pixel + c]));
    count += worst > kChannelTolerance ? 1 : 0;
  }
  return count;
}

void expect_golden(const std::string& name, Primary primary) {
  RenderOptions options;
  options.width = options.height = 160;
  options.primary = primary;
  const Image picture = tone_mapped(render(builtin_scene(name), options));
  const char* update = std::getenv("RAYSHEAF_UPDATE_GOLDEN");
  if (update != nullptr && primary == Primary::kTrace) write_png(picture, golden_path(name));
  const Image golden = test::read_png(golden_path(name));
  ASSERT_EQ(golden.width, picture.width);
  ASSERT_EQ(golden.height, picture.height);
  EXPECT_LE(different_pixels(picture, golden), std::size_t{160 * 160 / 200});
}

class Golden : public testing::TestWithParam<const char*> {};

TEST_P(Golden, TracedPictureIsTheGoldenOne) {
  expect_golden(GetParam(), Primary::kTrace);
}

TEST_P(Golden, RasterisedPictureIsTheGoldenOne) {
  try {
    expect_golden(GetParam(), Primary::kRaster);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNoGraphics) throw;
    GTEST_SKIP() << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Builtin, Golden, testing::Values("office", "cornell", "atrium"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace raysheaf
