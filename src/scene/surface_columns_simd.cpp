// Compiled once a SIMD target and chosen at run time (Google Highway). No operation is fused, so
// that every target gives the bits of the scalar functions.
#include <cstring>

#include <hwy/cache_control.h>

#include "base/float.h"
#include "intersect/triangle_body.h"
#include "scene/surface_columns.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/surface_columns_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// As many floats as a vector has doubles: the two go side by side.
using Doubles = hn::CappedTag<double, kSurfaceLanes>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::RebindToSigned<Floats>;
using F = hn::Vec<Floats>;
using D = hn::Vec<Doubles>;
using I = hn::Vec<Ints>;
using FM = hn::Mask<Floats>;
using DM = hn::Mask<Doubles>;

struct F3 {
  F x, y, z;
};
struct D3 {
  D x, y, z;
};

HWY_INLINE F set(float x) {
  return hn::Set(Floats(), x);
}
HWY_INLINE F load(const SurfaceColumn& column, std::size_t k) {
  return hn::Load(Floats(), column + k);
}
HWY_INLINE F3 load3(const SurfaceColumn (&columns)[3], std::size_t k) {
  return {load(columns[0], k), load(columns[1], k), load(columns[2], k)};
}
HWY_INLINE void store(F x, SurfaceColumn& column, std::size_t k) {
  hn::Store(x, Floats(), column + k);
}
HWY_INLINE void store3(const F3& a, SurfaceColumn (&columns)[3], std::size_t k) {
  store(a.x, columns[0], k);
  store(a.y, columns[1], k);
  store(a.z, columns[2], k);
}
template <class Tag, class Mask>
HWY_INLINE LaneBits bits_of(Tag d, Mask mask, std::size_t k) {
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::uint16_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return (bits & ((1u << hn::Lanes(d)) - 1)) << k;
}
/// The lanes of `bits` from `k` on.
HWY_INLINE FM mask_of(LaneBits bits, std::size_t k) {
  const Ints d;
  const I bit = hn::Shl(hn::Set(d, 1), hn::Iota(d, 0));
  return hn::RebindMask(
      Floats(),
      hn::Ne(hn::And(hn::Set(d, static_cast<std::int32_t>(bits >> k)), bit), hn::Zero(d)));
}

HWY_INLINE F3 minus(const F3& a, const F3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE F dot(const F3& a, const F3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE F larger(F a, F b) {
  return hn::IfThenElse(hn::Gt(a, b), a, b);
}
HWY_INLINE F3 select(FM mask, const F3& yes, const F3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE F3 negated(const F3& a) {
  return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}

HWY_INLINE D3 widened(const F3& a) {
  const Doubles d;
  return {hn::PromoteTo(d, a.x), hn::PromoteTo(d, a.y), hn::PromoteTo(d, a.z)};
}
HWY_INLINE D3 difference(const F3& a, const F3& b) {
  const D3 p = widened(a), q = widened(b);
  return {hn::Sub(p.x, q.x), hn::Sub(p.y, q.y), hn::Sub(p.z, q.z)};
}
HWY_INLINE D3 cross(const D3& a, const D3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE D dot(const D3& a, const D3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE FM narrowed(DM mask) {
  const Doubles d;
  const Floats df;
  return hn::Ne(hn::DemoteTo(df, hn::IfThenElseZero(mask, hn::Set(d, 1.0))), hn::Zero(df));
}
/// `unit`; `known`: the lanes that have a direction, others hold anything.
HWY_INLINE F3 unit(const D3& a, FM* known) {
  const Doubles d;
  const Floats df;
  const D size = hn::Sqrt(dot(a, a));
  const D infinite = hn::Set(d, std::numeric_limits<double>::infinity());
  *known = narrowed(hn::And(hn::Gt(size, hn::Zero(d)), hn::Lt(size, infinite)));
  return {hn::DemoteTo(df, hn::Div(a.x, size)), hn::DemoteTo(df, hn::Div(a.y, size)),
          hn::DemoteTo(df, hn::Div(a.z, size))};
}

/// Where a column of weights mixes corners' values: `mixed` and what `mixed_point` begins with.
struct Weights {
  F first, second, third;
};
HWY_INLINE Weights weights_at(const SurfaceColumns& c, std::size_t k) {
  const F u = load(c.u, k), v = load(c.v, k);
  return {hn::Sub(hn::Sub(set(1), u), v), u, v};
}
HWY_INLINE F mix(const Weights& w, F a, F b, F c) {
  return hn::Add(hn::Add(hn::Mul(a, w.first), hn::Mul(b, w.second)), hn::Mul(c, w.third));
}

/// A ray's components as its triangle's test has them (intersect/triangle_body.h).
struct Sheared {
  FM is_x, is_y, turned;
  F shear_x, shear_y;

  HWY_INLINE F along(const F3& a) const {
    return hn::IfThenElse(is_x, a.x, hn::IfThenElse(is_y, a.y, a.z));
  }
  HWY_INLINE F next(const F3& a) const {
    return hn::IfThenElse(is_x, a.y, hn::IfThenElse(is_y, a.z, a.x));
  }
  HWY_INLINE F last(const F3& a) const {
    return hn::IfThenElse(is_x, a.z, hn::IfThenElse(is_y, a.x, a.y));
  }
  HWY_INLINE F across(const F3& a) const { return hn::IfThenElse(turned, last(a), next(a)); }
  HWY_INLINE F up(const F3& a) const { return hn::IfThenElse(turned, next(a), last(a)); }
  /// x and y sheared, z as it is.
  HWY_INLINE F3 operator()(const F3& a) const {
    const F z = along(a);
    return {hn::Sub(across(a), hn::Mul(shear_x, z)), hn::Sub(up(a), hn::Mul(shear_y, z)), z};
  }
};

LaneBits FindWeights(SurfaceColumns* columns) {
  SurfaceColumns& c = *columns;
  const Floats d;
  const F zero = hn::Zero(d);
  LaneBits settled = 0;
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(d)) {
    const F3 direction = load3(c.direction, k), origin = load3(c.origin, k);
    const F3 m{hn::Abs(direction.x), hn::Abs(direction.y), hn::Abs(direction.z)};
    const FM x_over_y = hn::Gt(m.x, m.y);
    Sheared s;
    s.is_x = hn::And(x_over_y, hn::Gt(m.x, m.z));
    s.is_y = hn::AndNot(x_over_y, hn::Gt(m.y, m.z));
    const F along = s.along(direction);
    s.turned = hn::Lt(along, zero);
    s.shear_x = hn::Div(s.across(direction), along);
    s.shear_y = hn::Div(s.up(direction), along);
    const F shear_z = hn::Div(set(1), along);
    const F3 p = s(minus(load3(c.corner[0], k), origin));
    const F3 q = s(minus(load3(c.corner[1], k), origin));
    const F3 r = s(minus(load3(c.corner[2], k), origin));
    const F u0 = hn::Mul(r.x, q.y), u1 = hn::Mul(r.y, q.x);
    const F v0 = hn::Mul(p.x, r.y), v1 = hn::Mul(p.y, r.x);
    const F w0 = hn::Mul(q.x, p.y), w1 = hn::Mul(q.y, p.x);
    const F u = hn::Sub(u0, u1), v = hn::Sub(v0, v1), w = hn::Sub(w0, w1);
    const FM below = hn::And(hn::And(hn::Lt(u, zero), hn::Lt(v, zero)), hn::Lt(w, zero));
    const FM above = hn::And(hn::And(hn::Gt(u, zero), hn::Gt(v, zero)), hn::Gt(w, zero));
    const F det = hn::Add(hn::Add(u, v), w), size = hn::Abs(det);
    const F spread =
        hn::Add(hn::Add(hn::Add(hn::Abs(u0), hn::Abs(u1)), hn::Add(hn::Abs(v0), hn::Abs(v1))),
                hn::Add(hn::Abs(w0), hn::Abs(w1)));
    const F distance =
        hn::Add(hn::Add(hn::Mul(u, hn::Mul(shear_z, p.z)), hn::Mul(v, hn::Mul(shear_z, q.z))),
                hn::Mul(w, hn::Mul(shear_z, r.z)));
    const F far = hn::Abs(distance);
    FM good = hn::And(hn::Ge(size, set(kSmallDeterminant)), hn::Le(size, set(kLargeDeterminant)));
    good = hn::And(good, hn::Le(spread, hn::Mul(set(kLargestSpread), size)));
    good = hn::And(good,
                   hn::And(hn::Ge(far, set(kSmallDistance)), hn::Le(far, set(kLargeDeterminant))));
    const F t = hn::Div(distance, det);
    good = hn::And(good, hn::And(hn::Ge(t, load(c.t_min, k)), hn::Le(t, load(c.t_max, k))));
    good = hn::And(good, hn::Or(below, above));
    store(hn::Div(v, det), c.u, k);
    store(hn::Div(w, det), c.v, k);
    settled |= bits_of(d, good, k);
  }
  return settled;
}

LaneBits FindIncoming(SurfaceColumns* columns) {
  SurfaceColumns& c = *columns;
  const Floats d;
  LaneBits right = 0;
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(d)) {
    const F3 a = load3(c.direction, k);
    const F n = hn::Sqrt(dot(a, a));
    store3({hn::Div(a.x, n), hn::Div(a.y, n), hn::Div(a.z, n)}, c.incoming, k);
    right |= bits_of(d, hn::And(hn::Gt(n, set(1e-15f)), hn::Lt(n, set(1e15f))), k);
  }
  return right;
}

/// The corners' normals mixed, and taken where the instance takes them.
HWY_INLINE F3 mapped_normal(const SurfaceColumns& c, std::size_t k, const Weights& w,
                            const NormalMap& map, FM* known) {
  const Doubles d;
  const auto mixed = [&](std::size_t axis) {
    return mix(w, load(c.normal[0][axis], k), load(c.normal[1][axis], k),
               load(c.normal[2][axis], k));
  };
  const D3 wide = widened({mixed(0), mixed(1), mixed(2)});
  const D side = hn::Set(d, map.side);
  const D3 n{hn::Mul(side, wide.x), hn::Mul(side, wide.y), hn::Mul(side, wide.z)};
  const auto sum = [&](double yz, double zx, double xy) {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, yz), n.x), hn::Mul(hn::Set(d, zx), n.y)),
                   hn::Mul(hn::Set(d, xy), n.z));
  };
  return unit({sum(map.yz.x, map.zx.x, map.xy.x), sum(map.yz.y, map.zx.y, map.xy.y),
               sum(map.yz.z, map.zx.z, map.xy.z)},
              known);
}

LaneBits PlaceSurfaces(const InstanceLanes* instances, std::size_t count, LaneBits mirrored,
                       SurfaceColumns* columns, LaneBits* front) {
  SurfaceColumns& c = *columns;
  const Floats d;
  const Doubles dd;
  LaneBits right = 0, in_front = 0;
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(d)) {
    const F3 p = load3(c.corner[0], k), q = load3(c.corner[1], k), r = load3(c.corner[2], k);
    FM known;
    const F3 normal = unit(cross(difference(q, p), difference(r, p)), &known);
    const F3 facing = select(mask_of(mirrored, k), negated(normal), normal);
    // Nothing of it may have vanished.
    const F zero = hn::Zero(d);
    const FM flat =
        hn::And(hn::And(hn::Eq(facing.x, zero), hn::Eq(facing.y, zero)), hn::Eq(facing.z, zero));
    right |= bits_of(d, hn::AndNot(flat, known), k);

    const Weights w = weights_at(c, k);
    const auto point = [&](F x, F y, F z, SurfaceColumn& out) {
      const F from_p = hn::Mul(x, w.first), from_q = hn::Mul(y, w.second);
      const F from_r = hn::Mul(z, w.third);
      const F sum = hn::Add(hn::Add(hn::Abs(from_p), hn::Abs(from_q)), hn::Abs(from_r));
      store(hn::Add(hn::Add(from_p, from_q), from_r), out, k);
      return hn::Add(hn::Mul(sum, set(gamma(5))), hn::Mul(hn::Abs(x), set(gamma(2))));
    };
    F error = point(p.x, q.x, r.x, c.position[0]);
    error = larger(error, point(p.y, q.y, r.y, c.position[1]));
    error = larger(error, point(p.z, q.z, r.z, c.position[2]));
    store(hn::Add(error, set(0x1p-147f)), c.error, k);

    const D along = dot(widened(facing), widened(load3(c.incoming, k)));
    const FM behind = narrowed(hn::Gt(along, hn::Zero(dd)));
    F3 shading = facing;
    for (std::size_t i = 0; i < count; ++i) {
      if ((instances[i].lanes >> k & ((1u << hn::Lanes(d)) - 1)) == 0) continue;
      FM has_direction;
      const F3 mapped = mapped_normal(c, k, w, instances[i].map, &has_direction);
      shading = select(hn::And(mask_of(instances[i].lanes, k), has_direction), mapped, shading);
    }
    store3(select(behind, negated(facing), facing), c.geometric, k);
    store3(select(behind, negated(shading), shading), c.shading, k);
    in_front |= bits_of(d, hn::Not(behind), k);
  }
  *front = in_front;
  return right;
}

/// `wrapped`.
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

/// `wrapped_texel`.
HWY_INLINE I wrapped_texels(Wrap wrap, I i, std::int32_t count) {
  const Ints d;
  const I first = hn::Zero(d), last = hn::Set(d, count - 1);
  const bool repeats = wrap == Wrap::kRepeat;
  const I below = repeats ? last : first, above = repeats ? first : last;
  return hn::IfThenElse(hn::Lt(i, first), below, hn::IfThenElse(hn::Gt(i, last), above, i));
}

/// Red, green and blue of texels at their places in the image.
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

/// Where the lanes see the texture: `transform_uv`, and where `wrapped` brings it, in texels.
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

/// The texels that `sample` mixes, and how; of the nearest filter the first alone.
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

HWY_EXPORT(FindWeights);
HWY_EXPORT(FindIncoming);
HWY_EXPORT(PlaceSurfaces);
HWY_EXPORT(LookUpColors);
HWY_EXPORT(PrefetchColors);

LaneBits find_weights(SurfaceColumns* columns) {
  return HWY_DYNAMIC_DISPATCH(FindWeights)(columns);
}

LaneBits find_incoming(SurfaceColumns* columns) {
  return HWY_DYNAMIC_DISPATCH(FindIncoming)(columns);
}

LaneBits place_surfaces(const InstanceLanes* instances, std::size_t count, LaneBits mirrored,
                        SurfaceColumns* columns, LaneBits* front) {
  return HWY_DYNAMIC_DISPATCH(PlaceSurfaces)(instances, count, mirrored, columns, front);
}

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
