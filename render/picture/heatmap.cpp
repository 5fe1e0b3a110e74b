// Tests per pixel in false colours, with a legend below the image:
//
//   +--------------------------+
//   |          image           |
//   +--------------------------+
//   |  [== colour bar =======] |
//   |  1   10   100   1k   10k |
//   |      tests per pixel     |
//   +--------------------------+
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "render/picture/bitmap_font.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kLeastWidth = 160;  // so that the legend is readable below any image
constexpr std::uint32_t kBarHeight = 10, kMargin = 8, kGap = 4, kTickLength = 3;
constexpr std::uint32_t kLegendHeight =
    kMargin + kBarHeight + kTickLength + kGap + kGlyphHeight + kGap + kGlyphHeight + kMargin;
constexpr float kLogarithmicFrom = 50;  // ratio of the largest to the least positive value
constexpr std::array<std::uint8_t, 3> kPaper = {16, 16, 20}, kInk = {230, 230, 230};

/// The position of a value on the colour bar, and the values that get a label.
struct Scale {
  double low = 0, high = 1;
  bool logarithmic = false;

  [[nodiscard]] float at(double value) const {
    if (logarithmic) {
      if (!(value > low)) return 0;
      return static_cast<float>(std::log(value / low) / std::log(high / low));
    }
    return static_cast<float>((value - low) / (high - low));
  }
};

double power_of_ten(double exponent) {
  return std::pow(10.0, exponent);
}

Scale scale_of(const std::vector<float>& tests) {
  double least = std::numeric_limits<double>::infinity(), largest = 0;
  for (const float value : tests) {
    if (!(value > 0) || !std::isfinite(value)) continue;
    least = std::min<double>(least, value);
    largest = std::max<double>(largest, value);
  }
  if (largest <= 0) return {};
  if (largest / least < kLogarithmicFrom) return {0, largest, false};
  return {power_of_ten(std::floor(std::log10(least))), largest, true};
}

std::vector<double> ticks(const Scale& scale) {
  std::vector<double> values;
  if (scale.logarithmic) {
    for (int i = 0; scale.low * power_of_ten(i) <= scale.high * 1.000001; ++i) {
      values.push_back(scale.low * power_of_ten(i));
    }
    return values;
  }
  // The round step (1, 2 or 5 times a power of ten) that gives three to six labels.
  const double magnitude = power_of_ten(std::floor(std::log10(scale.high)));
  double step = magnitude;
  if (scale.high / step < 2.5) step = scale.high / magnitude < 1.25 ? magnitude / 4 : magnitude / 2;
  if (scale.high / step > 6) step = magnitude * 2;
  for (int i = 0; i * step <= scale.high * 1.000001; ++i) values.push_back(i * step);
  return values;
}

std::string label(double value) {
  static constexpr char kSuffixes[] = {'\0', 'k', 'M', 'G', 'T'};
  std::size_t suffix = 0;
  while (value >= 999.5 && suffix + 1 < std::size(kSuffixes)) {
    value /= 1000;
    ++suffix;
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return suffix == 0 ? std::string(text) : text + std::string(1, kSuffixes[suffix]);
}

void set_pixel(Image& image, std::uint32_t x, std::uint32_t y, std::array<std::uint8_t, 3> color) {
  if (x >= image.width || y >= image.height) return;
  std::uint8_t* pixel = image.rgba.data() + (std::size_t{y} * image.width + x) * 4;
  std::copy(color.begin(), color.end(), pixel);
  pixel[3] = 255;
}

void fill(Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
          std::array<std::uint8_t, 3> color) {
  for (std::uint32_t row = y; row < y + height; ++row) {
    for (std::uint32_t column = x; column < x + width; ++column) {
      set_pixel(image, column, row, color);
    }
  }
}

void draw_label(Image& image, std::string_view text, std::uint32_t x, std::uint32_t y,
                std::uint32_t zoom) {
  draw_text(text, [&](std::uint32_t column, std::uint32_t row) {
    fill(image, x + column * zoom, y + row * zoom, zoom, zoom, kInk);
  });
}

void draw_picture(Image& image, const RenderResult& result, const Scale& scale) {
  for (std::uint32_t y = 0; y < result.height; ++y) {
    for (std::uint32_t x = 0; x < result.width; ++x) {
      const float value = result.tests[std::size_t{y} * result.width + x];
      set_pixel(image, x, y, value > 0 ? false_color(scale.at(value)) : kPaper);
    }
  }
}

// Labels are placed from the left; a label that would touch its neighbour is omitted, but its tick
// remains.
void draw_ticks(Image& image, const Scale& scale, std::uint32_t bar_width, std::uint32_t y,
                std::uint32_t zoom) {
  const std::uint32_t margin = kMargin * zoom;
  std::int64_t free_from = 0;
  for (const double value : ticks(scale)) {
    const auto x =
        margin + static_cast<std::uint32_t>(scale.at(value) * static_cast<float>(bar_width - zoom));
    fill(image, x, y, zoom, kTickLength * zoom, kInk);
    const std::string text = label(value);
    const std::int64_t width = std::int64_t{text_width(text)} * zoom;
    const std::int64_t left =
        std::clamp<std::int64_t>(x - width / 2, 0, std::int64_t{image.width} - width);
    if (left < free_from) continue;
    draw_label(image, text, static_cast<std::uint32_t>(left), y + (kTickLength + kGap) * zoom,
               zoom);
    free_from = left + width + std::int64_t{kGlyphAdvance} * zoom;
  }
}

void draw_legend(Image& image, const Scale& scale, std::uint32_t top, std::uint32_t zoom) {
  const std::uint32_t bar_width = image.width - 2 * kMargin * zoom;
  const std::uint32_t bar_top = top + kMargin * zoom, bar_bottom = bar_top + kBarHeight * zoom;
  for (std::uint32_t x = 0; x < bar_width; ++x) {
    const float t = static_cast<float>(x) / static_cast<float>(bar_width - 1);
    fill(image, kMargin * zoom + x, bar_top, 1, kBarHeight * zoom, false_color(t));
  }
  draw_ticks(image, scale, bar_width, bar_bottom, zoom);
  constexpr std::string_view kTitle = "tests per pixel";
  draw_label(image, kTitle, (image.width - text_width(kTitle) * zoom) / 2,
             bar_bottom + (kTickLength + kGap + kGlyphHeight + kGap) * zoom, zoom);
}

}  // namespace

Image heatmap(const RenderResult& result) {
  const std::size_t pixels = std::size_t{result.width} * result.height;
  if (pixels == 0 || result.tests.size() != pixels) {
    throw Error(ErrorCode::kInvalidArgument,
                "a heat map needs the tests of every pixel; set RenderOptions::count_pixel_tests",
                "heatmap");
  }
  Image image;
  image.name = "tests per pixel";
  image.width = std::max(result.width, kLeastWidth);
  const std::uint32_t zoom = std::clamp(image.width / 512, 1u, 8u);
  image.height = result.height + kLegendHeight * zoom;
  image.rgba.resize(std::size_t{image.width} * image.height * 4);
  fill(image, 0, 0, image.width, image.height, kPaper);
  const Scale scale = scale_of(result.tests);
  draw_picture(image, result, scale);
  draw_legend(image, scale, result.height, zoom);
  return image;
}

}  // namespace raysheaf
