// Heat maps: colours grow lighter with the value, the legend exists, and every input is handled.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "render/picture/bitmap_font.h"

namespace raysheaf {
namespace {

RenderResult with_tests(std::uint32_t width, std::uint32_t height, std::vector<float> tests) {
  RenderResult result;
  result.width = width;
  result.height = height;
  result.tests = std::move(tests);
  return result;
}

std::array<int, 3> pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = image.rgba.data() + (std::size_t{y} * image.width + x) * 4;
  return {p[0], p[1], p[2]};
}

double luminance(std::array<std::uint8_t, 3> color) {
  double sum = 0;
  const double weights[3] = {0.2126, 0.7152, 0.0722};
  for (int i = 0; i < 3; ++i) sum += weights[i] * std::pow(color[i] / 255.0, 2.2);
  return sum;
}

TEST(FalseColor, LuminanceGrowsAllTheWay) {
  double previous = -1;
  for (int i = 0; i <= 64; ++i) {
    const double now = luminance(false_color(static_cast<float>(i) / 64));
    EXPECT_GT(now, previous) << "step " << i;
    previous = now;
  }
}

TEST(FalseColor, ClampsWhatIsOutside) {
  EXPECT_EQ(false_color(-3), false_color(0));
  EXPECT_EQ(false_color(7), false_color(1));
  EXPECT_EQ(false_color(std::numeric_limits<float>::quiet_NaN()), false_color(0));
}

TEST(BitmapFont, LettersOfTheLegendAreDrawnAndDistinct) {
  const std::string_view letters = ".0123456789GMTeiklprstx";
  for (const char a : letters) {
    EXPECT_EQ(glyph(a).letter, a);
    for (const char b : letters) {
      if (a == b) continue;
      EXPECT_NE(glyph(a).rows, glyph(b).rows) << a << b;
    }
  }
}

TEST(Heatmap, RefusesAFrameWithoutTests) {
  try {
    (void)heatmap(with_tests(4, 4, {}));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
  }
  EXPECT_THROW((void)heatmap(with_tests(0, 0, {})), Error);
}

TEST(Heatmap, PictureOnTopLegendUnderneath) {
  const std::uint32_t width = 200, height = 50;
  std::vector<float> tests(width * height);
  for (std::uint32_t i = 0; i < tests.size(); ++i) tests[i] = static_cast<float>(i % width);
  const Image image = heatmap(with_tests(width, height, tests));
  EXPECT_EQ(image.width, width);
  EXPECT_GT(image.height, height + 30);
  EXPECT_EQ(image.rgba.size(), std::size_t{image.width} * image.height * 4);
  int lit = 0;
  for (std::uint32_t y = height; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) lit += pixel(image, x, y)[0] > 200;
  }
  EXPECT_GT(lit, 100);  // words and numbers
}

TEST(Heatmap, EqualValuesEqualColoursAndMoreIsLighter) {
  std::mt19937 random(3);
  for (const double spread : {2.0, 1e5}) {
    std::vector<float> tests(100);
    std::uniform_real_distribution<double> exponent(0, 1);
    for (float& value : tests) {
      value = static_cast<float>(std::pow(spread, exponent(random)) * 10);
    }
    tests[17] = tests[71];
    const Image image = heatmap(with_tests(10, 10, tests));
    EXPECT_EQ(pixel(image, 7, 1), pixel(image, 1, 7));
    for (std::uint32_t i = 0; i + 1 < tests.size(); ++i) {
      const auto a = pixel(image, i % 10, i / 10), b = pixel(image, (i + 1) % 10, (i + 1) / 10);
      const auto light = [](std::array<int, 3> c) { return 2 * c[0] + 7 * c[1] + c[2]; };
      if (tests[i] <= tests[i + 1] * 1.3f) continue;
      EXPECT_GT(light(a), light(b)) << tests[i];
    }
  }
}

TEST(Heatmap, ExtremesAndOddSizes) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float all[] = {0,      1,    -1,   inf, nan, std::numeric_limits<float>::max(),
                       1e-30f, 0.5f, 3e9f, 7};
  for (const float first : all) {
    for (const float second : all) {
      const Image image = heatmap(with_tests(2, 1, {first, second}));
      EXPECT_EQ(image.rgba.size(), std::size_t{image.width} * image.height * 4);
    }
  }
  const Image wide = heatmap(with_tests(5000, 1, std::vector<float>(5000, 12)));
  EXPECT_EQ(wide.width, 5000u);
  const Image tall = heatmap(with_tests(1, 3000, std::vector<float>(3000, 12)));
  EXPECT_GT(tall.height, 3000u);
}

}  // namespace
}  // namespace raysheaf
