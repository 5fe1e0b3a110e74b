// tone_mapped(): from radiance to a picture for people.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/bits.h"
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

/// IEC 61966-2-1, of [0, 1].
std::uint8_t srgb(float x) {
  const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(encoded * 255 + 0.5f);
}

/// `srgb` by a table: powers cost more than all else that a frame's picture needs here.
///
///   bits of x:  | exponent | 7 of the fraction | 16 more |
///               |<--------- bucket ----------->|
///
/// Within a bucket x grows by less than a 128th, and the code by less than 255 * 1.055 / 2.4 / 128:
/// at most one step, at `step_`.
class SrgbTable {
 public:
  SrgbTable() {
    for (std::uint32_t b = 0; b < kBuckets; ++b) {
      const std::uint32_t first = kFirst + (b << kRestBits);
      const std::uint32_t last = std::min(first + (1u << kRestBits) - 1, float_bits(1.0f));
      code_[b] = srgb(bits_float(first));
      step_[b] = last;  // the greatest that has the bucket's first code
      if (srgb(bits_float(last)) == code_[b]) continue;
      std::uint32_t low = first, high = last;
      while (high - low > 1) {
        const std::uint32_t middle = low + (high - low) / 2;
        (srgb(bits_float(middle)) == code_[b] ? low : high) = middle;
      }
      step_[b] = low;
    }
  }

  /// NaNs are black.
  [[nodiscard]] std::uint8_t operator()(float linear) const {
    if (!(linear >= kLeast)) return 0;
    const std::uint32_t bits = float_bits(linear < 1 ? linear : 1.0f);
    const std::uint32_t b = (bits - kFirst) >> kRestBits;
    return static_cast<std::uint8_t>(code_[b] + (bits > step_[b] ? 1 : 0));
  }

 private:
  static constexpr std::uint32_t kRestBits = 16, kOctaves = 13;
  static constexpr std::uint32_t kBuckets = (kOctaves << 7) + 1;   // and 1 itself
  static constexpr std::uint32_t kFirst = (127 - kOctaves) << 23;  // the bits of kLeast
  static constexpr float kLeast = 0x1p-13f;                        // all below are code 0

  std::array<std::uint8_t, kBuckets> code_{};
  std::array<std::uint32_t, kBuckets> step_{};
};

}  // namespace

Image tone_mapped(const RenderResult& result) {
  static const SrgbTable kSrgb;
  Image image;
  image.width = result.width;
  image.height = result.height;
  image.rgba.resize(result.beauty.size() * 4);
  std::uint8_t* out = image.rgba.data();
  for (const Vec3& radiance : result.beauty) {
    const Vec3 c = neutral_curve(max(radiance * result.exposure, {0, 0, 0}));
    *out++ = kSrgb(c.x);
    *out++ = kSrgb(c.y);
    *out++ = kSrgb(c.z);
    *out++ = 255;
  }
  return image;
}

}  // namespace raysheaf
