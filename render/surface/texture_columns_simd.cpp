// Texture look-ups for columns. Compiled once for each SIMD target and chosen at run time (Google
// Highway); computes the bits of texture_body.h.
#include <hwy/cache_control.h>

#include "render/surface/surface_columns.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/surface/texture_columns_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/surface/surface_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {

/// SIMD version of `wrapped`.
HWY_INLINE F wrapped_places(Wrap wrap, F x) {
  const Floats d;
  const F one = set(1), two = set(2);
  F place;
  if (wrap == Wrap::kClampToEdge) {
    place =
        hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Zero(d), hn::IfThenElse(hn::Gt(x, one), one, x));
  } else if (wrap == Wrap::kRepeat) {
    place = hn::Sub(x, hn::Floor(x));
  } else {
    const F in_period = hn::Sub(x, hn::Mul(two, hn::Floor(hn::Mul(x, set(0.5f)))));
    place = hn::IfThenElse(hn::Le(in_period, one), in_period, hn::Sub(two, in_period));
  }
  const FM finite = hn::Lt(hn::Abs(x), set(std::numeric_limits<float>::infinity()));
  return hn::IfThenElseZero(finite, place);
}

/// SIMD version of `wrapped_texel`.
HWY_INLINE I wrapped_texels(Wrap wrap, I i, std::int32_t count) {
  const Ints d;
  const I first = hn::Zero(d), last = hn::Set(d, count - 1);
  const bool repeats = wrap == Wrap::kRepeat;
  const I below = repeats ? last : first, above = repeats ? first : last;
  return hn::IfThenElse(hn::Lt(i, first), below, hn::IfThenElse(hn::Gt(i, last), above, i));
}

/// Red, green and blue of the texels at these indices of the image.
HWY_INLINE F3 texels(const TextureView& texture, const float* decode, I place) {
  const Floats d;
  const Ints di;
  const I byte = hn::Set(di, 255);
  const I rgba = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(texture.rgba), place);
  return {hn::GatherIndex(d, decode, hn::And(rgba, byte)),
          hn::GatherIndex(d, decode, hn::And(hn::ShiftRight<8>(rgba), byte)),
          hn::GatherIndex(d, decode, hn::And(hn::ShiftRight<16>(rgba), byte))};
}
HWY_INLINE F3 between(const F3& a, const F3& b, F t) {
  return {hn::Add(a.x, hn::Mul(hn::Sub(b.x, a.x), t)), hn::Add(a.y, hn::Mul(hn::Sub(b.y, a.y), t)),
          hn::Add(a.z, hn::Mul(hn::Sub(b.z, a.z), t))};
}

/// The lanes' places in the texture: `transform_uv`, then `wrapped`, in texels.
struct TexturePlace {
  F x, y;
};
HWY_INLINE TexturePlace texture_place(const SurfaceColumns& c, std::size_t k,
                                      const PlacedTexture& slot, const TextureView& texture) {
  const Weights w = weights_at(c, k);
  const auto mixed = [&](std::size_t axis) {
    return mix(w, load(c.uv[0][axis], k), load(c.uv[1][axis], k), load(c.uv[2][axis], k));
  };
  const F u = hn::Mul(mixed(0), set(slot.scale.x)), v = hn::Mul(mixed(1), set(slot.scale.y));
  F x = u, y = v;
  if (slot.rotated) {
    const F cosine = set(slot.cosine), sine = set(slot.sine);
    x = hn::Add(hn::Mul(cosine, u), hn::Mul(sine, v));
    y = hn::Sub(hn::Mul(cosine, v), hn::Mul(sine, u));
  }
  x = wrapped_places(texture.wrap_u, hn::Add(x, set(slot.offset.x)));
  y = wrapped_places(texture.wrap_v, hn::Add(y, set(slot.offset.y)));
  return {hn::Mul(x, set(static_cast<float>(texture.width))),
          hn::Mul(y, set(static_cast<float>(texture.height)))};
}

/// The texels that `sample` interpolates, and their weights; for the nearest filter only the first.
struct TexelMix {
  I x0, x1, y0, y1;
  F right_part, bottom_part;
};
HWY_INLINE TexelMix texel_mix(const TextureView& texture, const TexturePlace& at) {
  const Ints di;
  const auto width = static_cast<std::int32_t>(texture.width);
  const auto height = static_cast<std::int32_t>(texture.height);
  TexelMix mix;
  if (texture.filter == Filter::kNearest) {
    mix.x0 = mix.x1 = hn::Min(hn::ConvertTo(di, at.x), hn::Set(di, width - 1));
    mix.y0 = mix.y1 = hn::Min(hn::ConvertTo(di, at.y), hn::Set(di, height - 1));
    mix.right_part = mix.bottom_part = hn::Zero(Floats());
    return mix;
  }
  const F x = hn::Sub(at.x, set(0.5f)), y = hn::Sub(at.y, set(0.5f));
  const F left = hn::Floor(x), top = hn::Floor(y);
  const I i = hn::ConvertTo(di, left), j = hn::ConvertTo(di, top), one = hn::Set(di, 1);
  mix.x0 = wrapped_texels(texture.wrap_u, i, width);
  mix.x1 = wrapped_texels(texture.wrap_u, hn::Add(i, one), width);
  mix.y0 = wrapped_texels(texture.wrap_v, j, height);
  mix.y1 = wrapped_texels(texture.wrap_v, hn::Add(j, one), height);
  mix.right_part = hn::Sub(x, left);
  mix.bottom_part = hn::Sub(y, top);
  return mix;
}
HWY_INLINE I place_of(const TextureView& texture, I column, I row) {
  return hn::Add(hn::Mul(row, hn::Set(Ints(), static_cast<std::int32_t>(texture.width))), column);
}

void LookUpColors(const TextureTable& table, const PlacedTexture& slot, const float* decode,
                  SurfaceColumns* columns) {
  SurfaceColumns& c = *columns;
  const TextureView& texture = table.textures.data[slot.texture];
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(Floats())) {
    const TexelMix m = texel_mix(texture, texture_place(c, k, slot, texture));
    const auto color_at = [&](I column, I row) {
      return texels(texture, decode, place_of(texture, column, row));
    };
    if (texture.filter == Filter::kNearest) {
      store3(color_at(m.x0, m.y0), c.color, k);
      continue;
    }
    const F3 top = between(color_at(m.x0, m.y0), color_at(m.x1, m.y0), m.right_part);
    const F3 bottom = between(color_at(m.x0, m.y1), color_at(m.x1, m.y1), m.right_part);
    store3(between(top, bottom, m.bottom_part), c.color, k);
  }
}

void PrefetchColors(const TextureTable& table, const PlacedTexture& slot,
                    const SurfaceColumns& columns) {
  const TextureView& texture = table.textures.data[slot.texture];
  alignas(64) std::int32_t first[kSurfaceLanes], second[kSurfaceLanes];
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(Floats())) {
    const TexelMix m = texel_mix(texture, texture_place(columns, k, slot, texture));
    hn::Store(place_of(texture, m.x0, m.y0), Ints(), first + k);
    hn::Store(place_of(texture, m.x0, m.y1), Ints(), second + k);
  }
  for (std::size_t i = 0; i < kSurfaceLanes; ++i) {
    hwy::Prefetch(texture.rgba + 4 * static_cast<std::size_t>(first[i]));
    hwy::Prefetch(texture.rgba + 4 * static_cast<std::size_t>(second[i]));
  }
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(LookUpColors);
HWY_EXPORT(PrefetchColors);

void look_up_colors(const TextureTable& table, const PlacedTexture& slot, const float* decode,
                    SurfaceColumns* columns) {
  HWY_DYNAMIC_DISPATCH(LookUpColors)(table, slot, decode, columns);
}

void prefetch_colors(const TextureTable& table, const PlacedTexture& slot,
                     const SurfaceColumns& columns) {
  HWY_DYNAMIC_DISPATCH(PrefetchColors)(table, slot, columns);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
