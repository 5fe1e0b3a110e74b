// SIMD lanes of rays, bundles of sixteen rays and their beams: filled, and tested with boxes.
// Included once for each SIMD target by methods/dual/trace_simd.cpp, inside its namespace.

using Rays = hn::CappedTag<float, kBundleWidth>;
using RayInts = hn::RebindToUnsigned<Rays>;
using RV = hn::Vec<Rays>;
using RM = hn::Mask<Rays>;
using Boxes = hn::CappedTag<float, kBvhWidth>;
using BV = hn::Vec<Boxes>;

HWY_INLINE std::size_t ray_lanes() {
  return hn::Lanes(Rays());
}

HWY_INLINE RV load(const float* p) {
  return hn::Load(Rays(), p);
}
HWY_INLINE RV set(float x) {
  return hn::Set(Rays(), x);
}

HWY_INLINE RM lanes_of(std::uint32_t bits, std::size_t g) {
  return mask_of(Rays(), bits >> g);
}

/// Clamps away from zero and keeps the sign, so that the inverse is finite.
template <class D>
HWY_INLINE hn::Vec<D> inverse_slope(D d, hn::Vec<D> slope) {
  const auto safe = hn::Max(hn::Abs(slope), hn::Set(d, kLeastSlope));
  return hn::Div(hn::CopySign(hn::Set(d, 1.0f), slope), safe);
}
inline float inverse_slope(float slope) {
  const float size = std::fabs(slope) > kLeastSlope ? std::fabs(slope) : kLeastSlope;
  return std::copysign(1.0f, slope) / size;
}

/// Loads four floats of a record, for as many records as a vector has lanes: field k of list[i]
/// goes to lane i of fk.
template <class Record>
HWY_INLINE void gather4(const Record* records, int quad, const std::uint32_t* list, RV& f0, RV& f1,
                        RV& f2, RV& f3) {
  static_assert(sizeof(Record) % 16 == 0);
  const auto at = [&](std::size_t i) __attribute__((always_inline)) {
    return reinterpret_cast<const float*>(records + list[i]) + 4 * quad;
  };
  gather4(Rays(), at, f0, f1, f2, f3);
}

/// The reverse, for consecutive records: lane i of fk goes to field k of records[i].
template <class Record>
HWY_INLINE void store4(RV f0, RV f1, RV f2, RV f3, int quad, Record* records) {
  static_assert(sizeof(Record) % 16 == 0);
  const auto at = [&](std::size_t i) __attribute__((always_inline)) {
    return reinterpret_cast<float*>(records + i) + 4 * quad;
  };
  scatter4(Rays(), f0, f1, f2, f3, at);
}

// Bundles of rays.

/// SIMD version of `raysheaf::past`.
HWY_INLINE RV past(RV t, RV along) {
  return hn::Mul(hn::Mul(hn::Add(t, set(kLeastStep)), along), set(1 + 8 * kUnitRoundoff));
}

/// Rays as vectors, along a quarter's axes.
template <class D>
struct RayLanesOf {
  hn::Vec<D> ox, oy, oz, dx, dy, dz, t_min, t_limit;
};
using RayLanes = RayLanesOf<Rays>;

/// Unused lanes get an empty interval.
HWY_INLINE RayLanes gather_lanes(const Ray* rays, const std::uint32_t* index, RM used,
                                 const QuarterAxes& axes) {
  RV o[3], d[3], t_min, t_max;
  gather4(rays, 0, index, o[0], o[1], o[2], t_min);
  gather4(rays, 1, index, d[0], d[1], d[2], t_max);
  return {o[axes.axis_x], o[axes.axis_y], o[axes.axis_z], d[axes.axis_x],
          d[axes.axis_y], d[axes.axis_z], t_min,          hn::IfThenElse(used, t_max, set(-1))};
}

/// At least kLeastStep times |d_z|, and always a normal number: processors take a hundred cycles or
/// more for a product with a subnormal number, and with t_min = 0 every ray would have one.
template <class D>
HWY_INLINE hn::Vec<D> least_step_of(D d, hn::Vec<D> along) {
  static_assert(kLeastStep == 0x1p-148f);
  const auto large = hn::Max(along, hn::Set(d, 0x1p23f));
  return hn::Mul(hn::Mul(large, hn::Set(d, 0x1p-100f)), hn::Set(d, 0x1p-48f));
}

/// A box seen by the rays of a quarter: the planes that they intersect first, and the others.
struct SeenBox {
  float x_near, x_far, y_near, y_far, z_near, z_far;
};

/// The planes of the scene's box, moved outwards, along a quarter's axes.
struct SceneBox : SeenBox {
  float low[3], high[3];  ///< as they are, along x, y and z
  float far;              ///< rays farther outside are far
  Growth growth;

  SceneBox(const Box& scene, const QuarterAxes& a) : growth(scene) {
    const int axis[3] = {a.axis_x, a.axis_y, a.axis_z};
    for (int i = 0; i < 3; ++i) {
      low[i] = component(scene.min, axis[i]);
      high[i] = component(scene.max, axis[i]);
    }
    const auto at = [&](int row, int i) { return row < 3 ? low[i] : high[i]; };
    const auto grown = [&](int row, int i) {
      const float plane = at(row, i), by = growth.of(plane);
      return row < 3 ? plane - by : plane + by;
    };
    x_near = grown(a.near_x, 0), x_far = grown(a.far_x, 0);
    y_near = grown(a.near_y, 1), y_far = grown(a.far_y, 1);
    z_near = at(a.near_z, 2), z_far = at(a.far_z, 2);
    far = kFarLengths * max_component(scene.max - scene.min);
  }

  /// The rays that begin far outside.
  [[nodiscard]] HWY_INLINE RM is_far(RV ox, RV oy, RV oz) const {
    const auto outside = [&](RV o, int i) HWY_ATTR {
      return hn::Max(hn::Sub(set(low[i]), o), hn::Sub(o, set(high[i])));
    };
    return hn::Gt(hn::Max(hn::Max(outside(ox, 0), outside(oy, 1)), outside(oz, 2)), set(far));
  }
};

/// Its planes relative to the rays' origins.
template <class D>
struct BoxFromOriginsOf {
  hn::Vec<D> x_near, x_far, y_near, y_far, z_near, z_far;

  HWY_INLINE BoxFromOriginsOf(const SeenBox& box, hn::Vec<D> ox, hn::Vec<D> oy, hn::Vec<D> oz) {
    const auto from = [](float plane, hn::Vec<D> o)
                          HWY_ATTR { return hn::Sub(hn::Set(D(), plane), o); };
    x_near = from(box.x_near, ox), x_far = from(box.x_far, ox);
    y_near = from(box.y_near, oy), y_far = from(box.y_far, oy);
    z_near = from(box.z_near, oz), z_far = from(box.z_far, oz);
  }
};

using BoxFromOrigins = BoxFromOriginsOf<Rays>;

/// Values derived from rays, as in StreamBundle.
template <class D>
struct SlabLanesOf {
  using V = hn::Vec<D>;
  V shear_x, shear_y, shear_z, along, per_x, per_y, s_near, s_far;

  HWY_INLINE SlabLanesOf(const RayLanesOf<D>& r, bool mirrored) {
    using hn::Mul, hn::Sub;
    const D d;
    along = hn::Abs(r.dz);
    const V step = least_step_of(d, along);
    shear_x = hn::Div(r.dx, r.dz);
    shear_y = hn::Div(r.dy, r.dz);
    shear_z = hn::Div(all(1), r.dz);
    per_x = inverse_slope(d, mirrored ? hn::Neg(shear_x) : shear_x);
    per_y = inverse_slope(d, mirrored ? hn::Neg(shear_y) : shear_y);
    const V bounding = hn::IfThenElseZero(hn::Lt(r.t_min, all(kLargeStart)), r.t_min);
    const V far = hn::Add(Mul(Mul(r.t_limit, along), all(1 + 8 * kUnitRoundoff)), step);
    s_near = Sub(Mul(Mul(bounding, along), all(1 - 8 * kUnitRoundoff)), step);
    s_far = hn::IfThenElse(hn::Lt(r.t_limit, hn::Zero(d)),
                           all(-std::numeric_limits<float>::infinity()), far);
  }

  /// Clips each ray to the scene's box; returns the lanes that intersect it. The others get an
  /// empty interval.
  HWY_INLINE hn::Mask<D> clip(const BoxFromOriginsOf<D>& scene, bool mirrored) {
    using hn::Max, hn::Min, hn::Mul, hn::Sub;
    const V near = Max(Max(Mul(scene.x_near, per_x), Mul(scene.y_near, per_y)),
                       Max(mirrored ? hn::Neg(scene.z_near) : scene.z_near, s_near));
    const V far = Min(Min(Mul(scene.x_far, per_x), Mul(scene.y_far, per_y)),
                      Min(mirrored ? hn::Neg(scene.z_far) : scene.z_far, s_far));
    const auto meets = hn::Le(near, hn::Add(far, Mul(hn::Abs(far), all(kFarther - 1))));
    // The roundings of the products, and those of later additions.
    const V rounding = all(8 * kUnitRoundoff);
    s_near = Sub(near, Mul(hn::Abs(near), rounding));
    s_far = hn::IfThenElse(meets, hn::Add(far, Mul(hn::Abs(far), rounding)),
                           all(-std::numeric_limits<float>::infinity()));
    return meets;
  }

 private:
  static HWY_INLINE V all(float x) { return hn::Set(D(), x); }
};
using SlabLanes = SlabLanesOf<Rays>;

struct PreparedLanes {
  std::uint32_t lanes;  ///< those near the scene that intersect its box
  std::uint32_t far;    ///< those that begin far outside
};

/// Prepares the rays of a bundle; `index` has kBundleWidth entries, of which `count` are used.
/// Calls `keep(g, rays, slabs)` for the lanes from g on.
template <class Keep>
HWY_INLINE PreparedLanes prepare_lanes(const Ray* rays, const std::uint32_t* index,
                                       std::uint32_t count, const SceneBox& scene,
                                       const QuarterAxes& axes, const Keep& keep) {
  const Rays d;
  const std::uint32_t all = count < kBundleWidth ? (1u << count) - 1 : 0xffffu;
  PreparedLanes prepared{0, 0};
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const RayLanes r = gather_lanes(rays, index + g, lanes_of(all, g), axes);
    SlabLanes slabs(r, axes.mirrored);
    prepared.far |= bits_of(d, scene.is_far(r.ox, r.oy, r.oz)) << g;
    const BoxFromOrigins box(scene, r.ox, r.oy, r.oz);
    prepared.lanes |= bits_of(d, slabs.clip(box, axes.mirrored)) << g;
    keep(g, r, slabs);
  }
  prepared.far &= all;
  prepared.lanes &= ~prepared.far;
  return prepared;
}

/// Copies `count` numbers, and repeats the first one up to kBundleWidth.
HWY_INLINE void copy_numbers(const std::uint32_t* from, std::uint32_t count, std::uint32_t* to) {
  if (HWY_LIKELY(count == kBundleWidth)) {
    std::memcpy(to, from, kBundleWidth * sizeof *to);
  } else {
    for (std::uint32_t i = 0; i < kBundleWidth; ++i) to[i] = from[i < count ? i : 0];
  }
}

// The beam of a bundle.

HWY_INLINE float least(RV v) {
  return hn::GetLane(hn::MinOfLanes(Rays(), v));
}

HWY_INLINE FourLanes least4(RV a, RV b, RV c, RV e) {
  return of_lanes4(Rays(), a, b, c, e, [](auto x, auto y) HWY_ATTR { return hn::Min(x, y); });
}
HWY_INLINE FourLanes greatest4(RV a, RV b, RV c, RV e) {
  return of_lanes4(Rays(), a, b, c, e, [](auto x, auto y) HWY_ATTR { return hn::Max(x, y); });
}

/// The plane through x = `at` with a slope, moved and tilted outwards; `side`: -1 for a lower one.
HWY_INLINE BeamPlane beam_plane(float at, float slope, float side, float pad) {
  return {at + side * pad, inverse_slope(slope + side * kBeamTilt)};
}

/// The range of x over the selected lanes, at zeta = 0 and at zeta = `length`.
struct Spread {
  RV low, high, low_end, high_end;
};
HWY_INLINE Spread spread_of(std::uint32_t lanes, const float* o, const float* shear, bool mirrored,
                            const float* zetas, float length) {
  const RV infinity = set(std::numeric_limits<float>::infinity());
  Spread s{infinity, hn::Neg(infinity), infinity, hn::Neg(infinity)};
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const RM on = lanes_of(lanes, g);
    const RV across = load(shear + g), slope = mirrored ? hn::Neg(across) : across;
    const RV zeta = load(zetas + g);
    const RV a = hn::Sub(load(o + g), hn::Mul(slope, zeta));
    const RV b = hn::Add(load(o + g), hn::Mul(slope, hn::Sub(set(length), zeta)));
    s.low = hn::Min(s.low, hn::IfThenElse(on, a, infinity));
    s.low_end = hn::Min(s.low_end, hn::IfThenElse(on, b, infinity));
    s.high = hn::Max(s.high, hn::IfThenElse(on, a, hn::Neg(infinity)));
    s.high_end = hn::Max(s.high_end, hn::IfThenElse(on, b, hn::Neg(infinity)));
  }
  return s;
}

/// The beam of the selected lanes, at least one.
HWY_INLINE Beam make_beam(std::uint32_t lanes, const StreamBundle& p, bool mirrored,
                          const Growth& growth) {
  const Rays d;
  alignas(64) float zetas[kBundleWidth];  // of the origins
  const float sign = mirrored ? -1.0f : 1.0f;
  const float first = p.oz[__builtin_ctz(lanes)];
  const RV infinity = set(std::numeric_limits<float>::infinity());
  RV nearest = infinity;
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const RV start =
        hn::Add(hn::Mul(set(sign), hn::Sub(load(p.oz + g), set(first))), load(p.s_near + g));
    nearest = hn::Min(nearest, hn::IfThenElse(lanes_of(lanes, g), start, infinity));
  }
  const float plane = first + sign * least(nearest);
  RV start = infinity, end = infinity, coordinate = hn::Zero(d), spread = hn::Zero(d);
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const RM on = lanes_of(lanes, g);
    const RV ox = load(p.ox + g), oy = load(p.oy + g), oz = load(p.oz + g);
    const RV zeta = hn::Mul(set(sign), hn::Sub(oz, set(plane)));
    hn::Store(zeta, d, zetas + g);
    const RV from = hn::Add(zeta, load(p.s_near + g)), to = hn::Add(zeta, load(p.s_far + g));
    const RV largest = hn::Max(hn::Max(hn::Abs(ox), hn::Abs(oy)), hn::Abs(oz));
    start = hn::Min(start, hn::IfThenElse(on, from, infinity));
    end = hn::Min(end, hn::IfThenElse(on, hn::Neg(to), infinity));
    coordinate = hn::Max(coordinate, hn::IfThenElseZero(on, largest));
    spread = hn::Max(spread, hn::IfThenElseZero(on, hn::Abs(zeta)));
  }
  const FourLanes ends = least4(start, end, hn::Neg(coordinate), hn::Neg(spread));
  const float pad = beam_pad(-ends.lane[2], -ends.lane[3], ends.lane[0], growth);
  Beam beam;
  beam.z_low = plane - pad;
  beam.z_high = plane + pad;
  beam.start = ends.lane[0] - pad;
  beam.end = pad - ends.lane[1];
  const float length = beam.end > 0 ? beam.end : 0;
  const Spread x = spread_of(lanes, p.ox, p.shear_x, mirrored, zetas, length);
  const Spread y = spread_of(lanes, p.oy, p.shear_y, mirrored, zetas, length);
  const FourLanes low = least4(x.low, x.low_end, y.low, y.low_end);
  const FourLanes high = greatest4(x.high, x.high_end, y.high, y.high_end);
  const float per_length = length > 0 ? 1 / length : 0;
  const auto plane_of = [&](const FourLanes& f, int axis, float side) {
    const float at = f.lane[2 * axis], last = f.lane[2 * axis + 1];
    return beam_plane(at, (last - at) * per_length, side, pad);
  };
  beam.x_low = plane_of(low, 0, -1);
  beam.x_high = plane_of(high, 0, 1);
  beam.y_low = plane_of(low, 1, -1);
  beam.y_high = plane_of(high, 1, 1);
  return beam;
}
