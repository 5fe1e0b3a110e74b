#include <algorithm>
#include <cmath>
#include <numbers>

#include "raysheaf/render.h"

namespace raysheaf {
namespace {

struct LinearColor {
  float r, g, b;
};

// Oklab (B. Ottosson, "A perceptual color space for image processing", 2020), from polar form.
LinearColor from_oklab(float lightness, float chroma, float hue_degrees) {
  const float hue = hue_degrees * std::numbers::pi_v<float> / 180;
  const float a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const float l_root = lightness + 0.3963377774f * a + 0.2158037573f * b;
  const float m_root = lightness - 0.1055613458f * a - 0.0638541728f * b;
  const float s_root = lightness - 0.0894841775f * a - 1.2914855480f * b;
  const float l = l_root * l_root * l_root;
  const float m = m_root * m_root * m_root;
  const float s = s_root * s_root * s_root;
  return {4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s,
          -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
          -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s};
}

bool in_gamut(const LinearColor& c) {
  const auto [low, high] = std::minmax({c.r, c.g, c.b});
  return low >= 0 && high <= 1;
}

// Lightness carries the value, so a colour outside sRGB only loses as much chroma as necessary.
// Bisection finds it, because a search in steps would show as bands.
LinearColor most_colorful(float lightness, float chroma, float hue_degrees) {
  if (in_gamut(from_oklab(lightness, chroma, hue_degrees))) {
    return from_oklab(lightness, chroma, hue_degrees);
  }
  float inside = 0, outside = chroma;
  for (int step = 0; step < 12; ++step) {
    const float middle = (inside + outside) / 2;
    (in_gamut(from_oklab(lightness, middle, hue_degrees)) ? inside : outside) = middle;
  }
  return from_oklab(lightness, inside, hue_degrees);
}

std::uint8_t srgb_byte(float linear) {
  const float x = std::clamp(linear, 0.f, 1.f);
  const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(encoded * 255 + 0.5f);
}

}  // namespace

std::array<std::uint8_t, 3> false_color(float t) {
  t = t > 0 ? std::min(t, 1.f) : 0.f;
  const float lightness = 0.22f + 0.74f * t;
  const float hue = 312 - 205 * t;
  const float chroma = 0.11f + 0.06f * t;
  const LinearColor color = most_colorful(lightness, chroma, hue);
  return {srgb_byte(color.r), srgb_byte(color.g), srgb_byte(color.b)};
}

}  // namespace raysheaf
