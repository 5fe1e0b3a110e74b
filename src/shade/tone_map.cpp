// tone_mapped(): from radiance to a picture for people.
#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "raysheaf/render.h"

namespace raysheaf {
namespace {

/// Khronos PBR Neutral (Khronos Group, "Khronos PBR Neutral Tone Mapper Specification", 2024):
/// colours below 0.8 stay as they are but for the toe that takes away the 4 % that dielectrics
/// reflect; brighter ones are compressed towards white.
Vec3 neutral_curve(Vec3 c) {
  constexpr float kReflectance = 0.04f, kStart = 0.8f - kReflectance, kDesaturation = 0.15f;
  const float least = min_component(c);
  const float toe =
      least < 2 * kReflectance ? least - least * least / (4 * kReflectance) : kReflectance;
  c = c - Vec3{toe, toe, toe};
  const float peak = max_component(c);
  if (peak < kStart) return c;
  const float d = 1 - kStart;
  const float compressed = 1 - d * d / (peak + d - kStart);
  const float g = 1 - 1 / (kDesaturation * (peak - compressed) + 1);
  return lerp(c * (compressed / peak), {compressed, compressed, compressed}, g);
}

/// IEC 61966-2-1.
std::uint8_t srgb(float linear) {
  const float x = clamp(linear, 0, 1);
  const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(encoded * 255 + 0.5f);
}

}  // namespace

Image tone_mapped(const RenderResult& result) {
  Image image;
  image.width = result.width;
  image.height = result.height;
  image.rgba.reserve(result.beauty.size() * 4);
  for (const Vec3& radiance : result.beauty) {
    const Vec3 c = neutral_curve(max(radiance * result.exposure, {0, 0, 0}));
    for (const float channel : {c.x, c.y, c.z}) image.rgba.push_back(srgb(channel));
    image.rgba.push_back(255);
  }
  return image;
}

}  // namespace raysheaf
