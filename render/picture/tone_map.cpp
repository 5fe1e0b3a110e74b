// tone_mapped(): converts radiance to an image for display.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "base/bits.h"
#include "base/vec.h"
#include "raysheaf/backdrop.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"

namespace raysheaf {
namespace {

/// Khronos PBR Neutral (Khronos Group, "Khronos PBR Neutral Tone Mapper Specification", 2024):
/// colours below 0.8 do not change, except for the toe that subtracts the 4 % that dielectrics
/// reflect; brighter colours are compressed towards white.
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

/// `srgb` by a table, because powers take more time than the rest of a frame's tone mapping.
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
      step_[b] = last;  // the largest x with the bucket's first code
      if (srgb(bits_float(last)) == code_[b]) continue;
      std::uint32_t low = first, high = last;
      while (high - low > 1) {
        const std::uint32_t middle = low + (high - low) / 2;
        (srgb(bits_float(middle)) == code_[b] ? low : high) = middle;
      }
      step_[b] = low;
    }
  }

  /// NaN becomes black.
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
  static constexpr float kLeast = 0x1p-13f;                        // all smaller numbers have code
                                                                   // 0

  std::array<std::uint8_t, kBuckets> code_{};
  std::array<std::uint32_t, kBuckets> step_{};
};

const SrgbTable& srgb_table() {
  static const SrgbTable kTable;
  return kTable;
}

/// The linear value of an sRGB code.
float linear_of(std::uint8_t code) {
  const float encoded = static_cast<float>(code) / 255;
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace

Image tone_mapped(const RenderResult& result) {
  const SrgbTable& to_srgb = srgb_table();
  Image image;
  image.width = result.width;
  image.height = result.height;
  image.rgba.resize(result.beauty.size() * 4);
  std::uint8_t* out = image.rgba.data();
  for (const Vec3& radiance : result.beauty) {
    const Vec3 c = neutral_curve(max(radiance * result.exposure, {0, 0, 0}));
    *out++ = to_srgb(c.x);
    *out++ = to_srgb(c.y);
    *out++ = to_srgb(c.z);
    *out++ = 255;
  }
  return image;
}

Rgba background_from_string(std::string_view text) {
  if (text == "white") return {255, 255, 255, 255};
  if (text == "black") return {0, 0, 0, 255};
  if (text == "transparent") return {0, 0, 0, 0};
  std::uint32_t code = 0;
  const char* end = text.data() + text.size();
  if (text.size() == 7 && text[0] == '#') {
    const auto [stop, error] = std::from_chars(text.data() + 1, end, code, 16);
    if (error == std::errc{} && stop == end) {
      return {static_cast<std::uint8_t>(code >> 16), static_cast<std::uint8_t>(code >> 8 & 255),
              static_cast<std::uint8_t>(code & 255), 255};
    }
  }
  throw Error(ErrorCode::kInvalidArgument,
              "'" + std::string(text) +
                  "' is none of white, black, transparent and #RRGGBB, such as #20262e",
              "background");
}

Backdrop::Backdrop(Rgba color) : color_(color) {}

void Backdrop::watch(RenderOptions* options) {
  normal_sums_.clear();
  covered_.clear();
  options->on_sample = [this](const RenderResult& so_far) {
    count(so_far, &normal_sums_, &covered_);
    return true;
  };
}

void Backdrop::count(const RenderResult& so_far, std::vector<Vec3>* normal_sums,
                     std::vector<float>* covered) {
  normal_sums->resize(so_far.normal.size());
  covered->resize(so_far.normal.size());
  // Normals are unit vectors, and 0 if nothing is seen: the change of the mean reveals the newest
  // one.
  constexpr float kSeen = 0.5f;
  const auto samples = static_cast<float>(so_far.samples);
  for (std::size_t i = 0; i < covered->size(); ++i) {
    const Vec3 sum = so_far.normal[i] * samples;
    if (length(sum - (*normal_sums)[i]) > kSeen) (*covered)[i] += 1;
    (*normal_sums)[i] = sum;
  }
}

Image Backdrop::picture(const RenderResult& result) const {
  std::vector<Vec3> normal_sums = normal_sums_;
  std::vector<float> covered = covered_;
  count(result, &normal_sums, &covered);
  const SrgbTable& to_srgb = srgb_table();
  const Vec3 behind{linear_of(color_[0]), linear_of(color_[1]), linear_of(color_[2])};
  const float opacity = static_cast<float>(color_[3]) / 255;
  Image image;
  image.width = result.width;
  image.height = result.height;
  image.rgba.reserve(result.beauty.size() * 4);
  for (std::size_t i = 0; i < result.beauty.size(); ++i) {
    const float part = covered[i] / static_cast<float>(result.samples);
    // The shadow on a ground is black and lies in front of the background.
    const float shaded = result.ground.empty() ? 0 : result.ground[i];
    if (!(part > 0) && !(shaded > 0)) {
      image.rgba.insert(image.rgba.end(), color_.begin(), color_.end());
      continue;
    }
    const float free = std::max(1 - part - shaded, 0.0f), shows = free * opacity;
    const float alpha = part + shaded + shows;
    Vec3 mixed = behind * shows;
    if (part > 0) {
      const Vec3 scene = (result.beauty[i] - result.ambient * free) * (result.exposure / part);
      mixed = mixed + neutral_curve(max(scene, {0, 0, 0})) * part;
    }
    const auto byte = static_cast<std::uint8_t>(std::min(alpha, 1.0f) * 255 + 0.5f);
    image.rgba.insert(image.rgba.end(), {to_srgb(mixed.x / alpha), to_srgb(mixed.y / alpha),
                                         to_srgb(mixed.z / alpha), byte});
  }
  return image;
}

}  // namespace raysheaf
