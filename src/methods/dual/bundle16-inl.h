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

/// Reads no more bytes than were written, so that the processor forwards the store to the load.
template <class D, class M>
HWY_INLINE std::uint32_t bits_of(D d, M mask) {
  if constexpr (hn::MaxLanes(D()) <= 8) {
    std::uint8_t bits;
    hn::StoreMaskBits(d, mask, &bits);
    return bits;
  } else {
    std::uint8_t bytes[2];
    hn::StoreMaskBits(d, mask, bytes);
    std::uint16_t bits;
    hwy::CopyBytes<2>(bytes, &bits);
    return bits;
  }
}

HWY_INLINE RM lanes_of(std::uint32_t bits, std::size_t g) {
  const Rays d;
  const std::uint32_t from_g = bits >> g;
  std::uint8_t bytes[8] = {};
  hwy::CopyBytes<4>(&from_g, bytes);
  return hn::LoadMaskBits(d, bytes);
}

#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
#if HWY_TARGET == HWY_AVX2
/// For each selection of eight lanes: the lanes' numbers, four bits each, selected ones first.
struct ChosenFirst {
  std::uint32_t lanes[256] = {};
  constexpr ChosenFirst() {
    for (std::uint32_t chosen = 0; chosen < 256; ++chosen) {
      std::uint32_t shift = 0;
      for (const std::uint32_t turn : {1u, 0u}) {
        for (std::uint32_t lane = 0; lane < 8; ++lane) {
          if ((chosen >> lane & 1) != turn) continue;
          lanes[chosen] |= lane << shift;
          shift += 4;
        }
      }
    }
  }
};
inline constexpr ChosenFirst kChosenFirst;
#endif

/// Moves selected lanes to the front, in order. The lanes after them hold the others or 0. Returns
/// how many were selected.
template <class D>
HWY_INLINE std::uint32_t compress(D d, hn::Mask<D> chosen, hn::Vec<D>* v) {
#if HWY_TARGET == HWY_AVX2
  // Works like hn::Compress, with a static table: gcc 12 copies the table of Highway 1.0 to the
  // stack for each call.
  static_assert(hn::MaxLanes(D()) == 8 && sizeof(hn::TFromD<D>) == 4);
  alignas(32) static constexpr std::uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
  const std::uint32_t bits = bits_of(d, chosen);
  const hn::RebindToUnsigned<D> du;
  const auto lanes = hn::Set(du, kChosenFirst.lanes[bits]) >> hn::Load(du, kShifts);
  *v = hn::TableLookupLanes(*v, hn::IndicesFromVec(d, hn::And(lanes, hn::Set(du, 7))));
  return static_cast<std::uint32_t>(__builtin_popcount(bits));
#else
  *v = hn::Compress(*v, chosen);
  return static_cast<std::uint32_t>(hn::CountTrue(d, chosen));
#endif
}
#endif

/// Clamps away from zero and keeps the sign, so that the inverse is finite.
HWY_INLINE RV inverse_slope(RV slope) {
  const RV safe = hn::Max(hn::Abs(slope), set(kLeastSlope));
  return hn::Div(hn::CopySign(set(1), slope), safe);
}
inline float inverse_slope(float slope) {
  const float size = std::fabs(slope) > kLeastSlope ? std::fabs(slope) : kLeastSlope;
  return std::copysign(1.0f, slope) / size;
}
#if HWY_TARGET != HWY_SCALAR
/// Loads the vector's blocks of four lanes: block k from the four floats at `at(k)`.
inline constexpr std::size_t kBlocks = hn::MaxLanes(Rays()) / 4;
template <class At>
HWY_INLINE RV load_blocks(const At& at) {
  const Rays d;
  if constexpr (kBlocks == 4) {
    const hn::Half<Rays> d8;
    const hn::Half<hn::Half<Rays> > d4;
    return hn::Combine(d, hn::Combine(d8, hn::LoadU(d4, at(3)), hn::LoadU(d4, at(2))),
                       hn::Combine(d8, hn::LoadU(d4, at(1)), hn::LoadU(d4, at(0))));
  } else if constexpr (kBlocks == 2) {
    const hn::Half<Rays> d4;
    return hn::Combine(d, hn::LoadU(d4, at(1)), hn::LoadU(d4, at(0)));
  } else {
    return hn::LoadU(d, at(0));
  }
}
#endif

/// Loads four floats of a record, for as many records as a vector has lanes: field k of list[i]
/// goes to lane i of fk. Uses registers only, because memory that was stored in parts cannot be
/// loaded as a whole without waiting.
template <class Record>
HWY_INLINE void gather4(const Record* records, int quad, const std::uint32_t* list, RV& f0, RV& f1,
                        RV& f2, RV& f3) {
  static_assert(sizeof(Record) % 16 == 0);
  const Rays d;
  const auto at = [&](std::size_t i) {
    return reinterpret_cast<const float*>(records + list[i]) + 4 * quad;
  };
#if HWY_TARGET == HWY_SCALAR
  const float* from = at(0);
  f0 = hn::Set(d, from[0]);
  f1 = hn::Set(d, from[1]);
  f2 = hn::Set(d, from[2]);
  f3 = hn::Set(d, from[3]);
#else
  // Vector j holds the records j, 4 + j, 8 + j, ... in its blocks of four lanes.
  const auto blocks = [&](std::size_t j) __attribute__((always_inline)) {
    return load_blocks([&](std::size_t k) __attribute__((always_inline)) { return at(4 * k + j); });
  };
  const RV a = blocks(0), b = blocks(1), c = blocks(2), e = blocks(3);
  const hn::Repartition<std::uint64_t, Rays> d64;
  const auto low = [&](RV x, RV y) { return hn::BitCast(d64, hn::InterleaveLower(x, y)); };
  const auto high = [&](RV x, RV y) { return hn::BitCast(d64, hn::InterleaveUpper(d, x, y)); };
  f0 = hn::BitCast(d, hn::InterleaveLower(low(a, b), low(c, e)));
  f1 = hn::BitCast(d, hn::InterleaveUpper(d64, low(a, b), low(c, e)));
  f2 = hn::BitCast(d, hn::InterleaveLower(high(a, b), high(c, e)));
  f3 = hn::BitCast(d, hn::InterleaveUpper(d64, high(a, b), high(c, e)));
#endif
}

/// The reverse, for consecutive records: lane i of fk goes to field k of records[i].
template <class Record>
HWY_INLINE void store4(RV f0, RV f1, RV f2, RV f3, int quad, Record* records) {
  static_assert(sizeof(Record) % 16 == 0);
  const Rays d;
  const auto at = [&](std::size_t i) { return reinterpret_cast<float*>(records + i) + 4 * quad; };
#if HWY_TARGET == HWY_SCALAR
  float* to = at(0);
  to[0] = hn::GetLane(f0);
  to[1] = hn::GetLane(f1);
  to[2] = hn::GetLane(f2);
  to[3] = hn::GetLane(f3);
  static_cast<void>(d);
#else
  const auto store_blocks = [&](RV v, std::size_t j) __attribute__((always_inline)) {
    if constexpr (hn::MaxLanes(Rays()) == 16) {
      const hn::Half<Rays> d8;
      const hn::Half<hn::Half<Rays> > d4;
      const auto low = hn::LowerHalf(d8, v), high = hn::UpperHalf(d8, v);
      hn::Store(hn::LowerHalf(d4, low), d4, at(j));
      hn::Store(hn::UpperHalf(d4, low), d4, at(4 + j));
      hn::Store(hn::LowerHalf(d4, high), d4, at(8 + j));
      hn::Store(hn::UpperHalf(d4, high), d4, at(12 + j));
    } else if constexpr (hn::MaxLanes(Rays()) == 8) {
      const hn::Half<Rays> d4;
      hn::Store(hn::LowerHalf(d4, v), d4, at(j));
      hn::Store(hn::UpperHalf(d4, v), d4, at(4 + j));
    } else {
      hn::Store(v, d, at(j));
    }
  };
  const hn::Repartition<std::uint64_t, Rays> d64;
  const auto as64 = [&](RV v) { return hn::BitCast(d64, v); };
  const auto a = as64(hn::InterleaveLower(f0, f1)), b = as64(hn::InterleaveLower(f2, f3));
  const auto c = as64(hn::InterleaveUpper(d, f0, f1)), e = as64(hn::InterleaveUpper(d, f2, f3));
  store_blocks(hn::BitCast(d, hn::InterleaveLower(a, b)), 0);
  store_blocks(hn::BitCast(d, hn::InterleaveUpper(d64, a, b)), 1);
  store_blocks(hn::BitCast(d, hn::InterleaveLower(c, e)), 2);
  store_blocks(hn::BitCast(d, hn::InterleaveUpper(d64, c, e)), 3);
#endif
}

// Bundles of rays.

/// SIMD version of `raysheaf::past`.
HWY_INLINE RV past(RV t, RV along) {
  return hn::Mul(hn::Mul(hn::Add(t, set(kLeastStep)), along), set(1 + 8 * kUnitRoundoff));
}

/// Rays as vectors, along a quarter's axes.
struct RayLanes {
  RV ox, oy, oz, dx, dy, dz, t_min, t_limit;
};

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
HWY_INLINE RV least_step_of(RV along) {
  static_assert(kLeastStep == 0x1p-148f);
  return hn::Mul(hn::Mul(hn::Max(along, set(0x1p23f)), set(0x1p-100f)), set(0x1p-48f));
}

/// The planes of the scene's box, moved outwards, along a quarter's axes.
struct SceneBox {
  float x_near, x_far, y_near, y_far, z_near, z_far;
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
struct BoxFromOrigins {
  RV x_near, x_far, y_near, y_far, z_near, z_far;

  HWY_INLINE BoxFromOrigins(const SceneBox& box, RV ox, RV oy, RV oz) {
    const auto from = [](float plane, RV o) HWY_ATTR { return hn::Sub(set(plane), o); };
    x_near = from(box.x_near, ox), x_far = from(box.x_far, ox);
    y_near = from(box.y_near, oy), y_far = from(box.y_far, oy);
    z_near = from(box.z_near, oz), z_far = from(box.z_far, oz);
  }
};

/// Values derived from rays, as in StreamBundle.
struct SlabLanes {
  RV shear_x, shear_y, shear_z, along, per_x, per_y, s_near, s_far;

  HWY_INLINE SlabLanes(const RayLanes& r, bool mirrored) {
    using hn::Mul, hn::Sub;
    const Rays d;
    along = hn::Abs(r.dz);
    const RV step = least_step_of(along);
    shear_x = hn::Div(r.dx, r.dz);
    shear_y = hn::Div(r.dy, r.dz);
    shear_z = hn::Div(set(1), r.dz);
    per_x = inverse_slope(mirrored ? hn::Neg(shear_x) : shear_x);
    per_y = inverse_slope(mirrored ? hn::Neg(shear_y) : shear_y);
    const RV bounding = hn::IfThenElseZero(hn::Lt(r.t_min, set(kLargeStart)), r.t_min);
    const RV far = hn::Add(Mul(Mul(r.t_limit, along), set(1 + 8 * kUnitRoundoff)), step);
    s_near = Sub(Mul(Mul(bounding, along), set(1 - 8 * kUnitRoundoff)), step);
    s_far = hn::IfThenElse(hn::Lt(r.t_limit, hn::Zero(d)),
                           set(-std::numeric_limits<float>::infinity()), far);
  }

  /// Clips each ray to the scene's box; returns the lanes that intersect it. The others get an
  /// empty interval.
  HWY_INLINE RM clip(const BoxFromOrigins& scene, bool mirrored) {
    using hn::Max, hn::Min, hn::Mul, hn::Sub;
    const RV near = Max(Max(Mul(scene.x_near, per_x), Mul(scene.y_near, per_y)),
                        Max(mirrored ? hn::Neg(scene.z_near) : scene.z_near, s_near));
    const RV far = Min(Min(Mul(scene.x_far, per_x), Mul(scene.y_far, per_y)),
                       Min(mirrored ? hn::Neg(scene.z_far) : scene.z_far, s_far));
    const RM meets = hn::Le(near, hn::Add(far, Mul(hn::Abs(far), set(kFarther - 1))));
    // The roundings of the products, and those of later additions.
    const RV rounding = set(8 * kUnitRoundoff);
    s_near = Sub(near, Mul(hn::Abs(near), rounding));
    s_far = hn::IfThenElse(meets, hn::Add(far, Mul(hn::Abs(far), rounding)),
                           set(-std::numeric_limits<float>::infinity()));
    return meets;
  }
};

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

struct FourLanes {
  alignas(16) float lane[4];
};
/// Reduces the lanes of four vectors by `pick` in a third of the steps of four separate reductions.
template <class Pick>
HWY_INLINE FourLanes of_lanes4(RV a, RV b, RV c, RV e, const Pick& pick) {
  FourLanes four;
#if HWY_TARGET == HWY_SCALAR
  const RV all[4] = {a, b, c, e};
  for (int i = 0; i < 4; ++i) four.lane[i] = hn::GetLane(all[i]);
  static_cast<void>(pick);
#else
  const Rays d;
  const hn::Repartition<std::uint64_t, Rays> d64;
  // a b a b, and of their halves a b c e, in each block of four lanes.
  const auto ab = hn::BitCast(d64, pick(hn::InterleaveLower(a, b), hn::InterleaveUpper(d, a, b)));
  const auto ce = hn::BitCast(d64, pick(hn::InterleaveLower(c, e), hn::InterleaveUpper(d, c, e)));
  const auto in_blocks = pick(hn::BitCast(d, hn::InterleaveLower(ab, ce)),
                              hn::BitCast(d, hn::InterleaveUpper(d64, ab, ce)));
  const auto fold = [&](auto half, auto v)
                        HWY_ATTR { return pick(hn::LowerHalf(half, v), hn::UpperHalf(half, v)); };
  if constexpr (kBlocks == 4) {
    const hn::Half<Rays> d8;
    const hn::Half<hn::Half<Rays> > d4;
    hn::Store(fold(d4, fold(d8, in_blocks)), d4, four.lane);
  } else if constexpr (kBlocks == 2) {
    const hn::Half<Rays> d4;
    hn::Store(fold(d4, in_blocks), d4, four.lane);
  } else {
    hn::Store(in_blocks, d, four.lane);
  }
#endif
  return four;
}
HWY_INLINE FourLanes least4(RV a, RV b, RV c, RV e) {
  return of_lanes4(a, b, c, e, [](auto x, auto y) HWY_ATTR { return hn::Min(x, y); });
}
HWY_INLINE FourLanes greatest4(RV a, RV b, RV c, RV e) {
  return of_lanes4(a, b, c, e, [](auto x, auto y) HWY_ATTR { return hn::Max(x, y); });
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
