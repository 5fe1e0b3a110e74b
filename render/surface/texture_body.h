// The look-up of one texel value in one texture.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec.h"
#include "base/view.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

/// A texture in the form that the look-up uses.
struct TextureView {
  const std::uint8_t* rgba{};
  std::uint32_t width = 0, height = 0;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  Filter filter = Filter::kLinear;
};

/// A slot in the form that the look-up uses: the sine and cosine of its rotation are computed once.
struct PlacedTexture {
  std::uint32_t texture = kInvalidId;
  Vec2 offset{0, 0}, scale{1, 1};
  float cosine = 1, sine = 0;
  bool rotated = false, second_uvs = false;
};
RAYSHEAF_HD inline PlacedTexture placed_texture(const TextureSlot& slot) {
  PlacedTexture placed{slot.texture,       slot.offset,    slot.scale, 1, 0,
                       slot.rotation != 0, slot.second_uvs};
  if (!placed.rotated) return placed;
  placed.cosine = std::cos(slot.rotation);
  placed.sine = std::sin(slot.rotation);
  return placed;
}

/// Scales, then rotates, then moves. Because `v` points down, counter-clockwise for a viewer of the
/// image takes +u towards -v.
RAYSHEAF_HD inline Vec2 transform_uv(const PlacedTexture& slot, Vec2 uv) {
  const float u = uv.x * slot.scale.x, v = uv.y * slot.scale.y;
  if (!slot.rotated) return {u + slot.offset.x, v + slot.offset.y};
  return {slot.cosine * u + slot.sine * v + slot.offset.x,
          slot.cosine * v - slot.sine * u + slot.offset.y};
}

/// Wraps a coordinate to [0, 1]; 0 if it is not finite.
RAYSHEAF_HD inline float wrapped(Wrap wrap, float x) {
  if (!std::isfinite(x)) return 0;
  if (wrap == Wrap::kClampToEdge) return clamp(x, 0, 1);
  if (wrap == Wrap::kRepeat) return x - std::floor(x);
  const float in_period = x - 2 * std::floor(x * 0.5f);
  return in_period <= 1 ? in_period : 2 - in_period;
}

/// Wraps the texel index -1 or `count`: to the opposite side if the texture repeats, to the border
/// texel if it mirrors or is clamped.
RAYSHEAF_HD inline std::uint32_t wrapped_texel(Wrap wrap, std::int64_t i, std::uint32_t count) {
  const std::int64_t last = static_cast<std::int64_t>(count) - 1;
  if (i < 0) i = wrap == Wrap::kRepeat ? last : 0;
  if (i > last) i = wrap == Wrap::kRepeat ? 0 : last;
  return static_cast<std::uint32_t>(i);
}

RAYSHEAF_HD inline Vec4 texel(const TextureView& texture, const float* decode, std::uint32_t x,
                              std::uint32_t y) {
  const std::uint8_t* p = texture.rgba + (static_cast<std::uint64_t>(y) * texture.width + x) * 4;
  return {decode[p[0]], decode[p[1]], decode[p[2]], static_cast<float>(p[3]) / 255};
}

RAYSHEAF_HD inline Vec4 mix(Vec4 a, Vec4 b, float t) {
  return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t,
          a.w + (b.w - a.w) * t};
}

/// The texture at `uv`, which is already transformed, at full resolution. Texel (i, j) has its
/// centre at ((i + 1/2) / width, (j + 1/2) / height). `decode` has 256 entries, the linear values
/// of the bytes of red, green and blue: texels are decoded before they are interpolated.
RAYSHEAF_HD inline Vec4 sample(const TextureView& texture, const float* decode, Vec2 uv) {
  const float x = wrapped(texture.wrap_u, uv.x) * static_cast<float>(texture.width);
  const float y = wrapped(texture.wrap_v, uv.y) * static_cast<float>(texture.height);
  const auto column_at = [&](std::int64_t i) {
    return wrapped_texel(texture.wrap_u, i, texture.width);
  };
  const auto row_at = [&](std::int64_t i) {
    return wrapped_texel(texture.wrap_v, i, texture.height);
  };
  if (texture.filter == Filter::kNearest) {
    // The edge of a repeating texture, where rounding reaches 1, still belongs to its last texel.
    const std::int64_t i = static_cast<std::int64_t>(x), j = static_cast<std::int64_t>(y);
    const std::uint32_t column =
        i < texture.width ? static_cast<std::uint32_t>(i) : texture.width - 1;
    const std::uint32_t row =
        j < texture.height ? static_cast<std::uint32_t>(j) : texture.height - 1;
    return texel(texture, decode, column, row);
  }
  const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  const std::int64_t i = static_cast<std::int64_t>(left), j = static_cast<std::int64_t>(top);
  const float right_part = x - 0.5f - left, bottom_part = y - 0.5f - top;
  const std::uint32_t x0 = column_at(i), x1 = column_at(i + 1), y0 = row_at(j), y1 = row_at(j + 1);
  return mix(mix(texel(texture, decode, x0, y0), texel(texture, decode, x1, y0), right_part),
             mix(texel(texture, decode, x0, y1), texel(texture, decode, x1, y1), right_part),
             bottom_part);
}

/// The textures of a scene. Read-only pointers.
struct TextureTable {
  View<const TextureView> textures;
  const float* from_srgb = nullptr;  ///< 256 entries each
  const float* as_is = nullptr;
};

/// White if the slot is empty. `uv`: of the set that the slot reads.
RAYSHEAF_HD inline Vec4 look_up(const TextureTable& table, const PlacedTexture& slot,
                                const float* decode, Vec2 uv) {
  if (slot.texture >= table.textures.size) return {1, 1, 1, 1};
  return sample(table.textures.data[slot.texture], decode, transform_uv(slot, uv));
}

/// A point in both of the mesh's sets of texture coordinates; they are equal if the mesh has one
/// set.
struct PlaceUv {
  Vec2 first, second;
};
RAYSHEAF_HD inline Vec4 look_up(const TextureTable& table, const PlacedTexture& slot,
                                const float* decode, const PlaceUv& uv) {
  return look_up(table, slot, decode, slot.second_uvs ? uv.second : uv.first);
}

}  // namespace raysheaf
