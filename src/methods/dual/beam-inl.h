// The beam of a bundle: made, and tested with boxes. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

/// A subtree that waits. In two words, each written and read whole: a load of what was stored in
/// smaller parts waits until they have reached the cache.
struct Waiting {
  std::uint64_t near_and_lanes, subtree;

  Waiting() = default;
  /// `near`: where the beam, or the ray, enters the box; `lanes`: that met it; `first` and `count`
  /// as in BvhNode.
  HWY_INLINE Waiting(float near, std::uint32_t lanes, std::uint32_t first, std::uint32_t count)
      : near_and_lanes(std::bit_cast<std::uint32_t>(near) | std::uint64_t{lanes} << 32),
        subtree(first | std::uint64_t{count} << 32) {}

  [[nodiscard]] HWY_INLINE float near() const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(near_and_lanes));
  }
  [[nodiscard]] HWY_INLINE std::uint32_t lanes() const {
    return static_cast<std::uint32_t>(near_and_lanes >> 32);
  }
  [[nodiscard]] HWY_INLINE std::uint32_t first() const {
    return static_cast<std::uint32_t>(subtree);
  }
  [[nodiscard]] HWY_INLINE std::uint32_t count() const {
    return static_cast<std::uint32_t>(subtree >> 32);
  }
  HWY_INLINE void copy_to(Waiting* to) const {
    const std::uint64_t a = near_and_lanes, b = subtree;
    to->near_and_lanes = a;
    to->subtree = b;
  }
};

/// The children whose boxes the beam meets, as bits; `near` takes where it enters them. `Bundle`:
/// RayBundle or RayStream.
template <class Bundle>
HWY_INLINE std::uint32_t children_in_beam(const Bundle& p, const Beam& b, const BvhNode& n,
                                          float* HWY_RESTRICT near) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  const Boxes d;
  std::uint32_t bits = 0;
  const auto row = [&](int r, std::size_t g) { return hn::Load(d, n.bound[r] + g); };
  for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
    const BV z_low = hn::Set(d, b.z_low), z_high = hn::Set(d, b.z_high);
    const BV z0 = row(p.near_z, g), z1 = row(p.far_z, g);
    BV lo = Max(p.mirrored ? Sub(z_low, z0) : Sub(z0, z_high), hn::Set(d, b.start));
    BV hi = Min(p.mirrored ? Sub(z_high, z1) : Sub(z1, z_low), hn::Set(d, b.end));
    const auto clip = [&](const BeamPlane& plane, BV bound, bool low) {
      const BV zeta = Mul(Sub(bound, hn::Set(d, plane.at)), hn::Set(d, plane.inverse));
      if ((plane.inverse > 0) == low) {
        hi = Min(hi, zeta);
      } else {
        lo = Max(lo, zeta);
      }
    };
    clip(b.x_low, row(p.axis_x + 3, g), true);
    clip(b.x_high, row(p.axis_x, g), false);
    clip(b.y_low, row(p.axis_y + 3, g), true);
    clip(b.y_high, row(p.axis_y, g), false);
    hn::StoreU(lo, d, near + g);
    bits |= bits_of(d, hn::Le(lo, hi)) << g;
  }
  return bits;
}

/// The farthest zeta at which any ray still looks for something.
HWY_INLINE float farthest_zeta(const RayBundle& p) {
  const Rays d;
  RV far = hn::Set(d, -std::numeric_limits<float>::infinity());
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
    far = hn::Max(far, hn::Add(load(p.zeta + g), load(p.s_far + g)));
  return hn::GetLane(hn::MaxOfLanes(d, far));
}
HWY_INLINE float least(RV v) {
  return hn::GetLane(hn::MinOfLanes(Rays(), v));
}

struct FourLanes {
  alignas(16) float lane[4];
};
/// What `pick` leaves of the lanes of four vectors each, in a third of the steps.
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
  // a b a b, and of their two halves a b c e, in each block of four lanes.
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

/// The range of x over the lanes that are set, where zeta = 0 and where it is `length`.
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

/// The beam of the lanes that are set: at least one. `Bundle`: RayBundle or StreamBlock. `zetas`
/// takes the origins' zeta.
template <class Bundle>
HWY_INLINE Beam make_beam(std::uint32_t lanes, const Bundle& p, bool mirrored, float pad,
                          float* zetas) {
  const Rays d;
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
  RV start = infinity, end = hn::Neg(infinity);
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const RM on = lanes_of(lanes, g);
    const RV zeta = hn::Mul(set(sign), hn::Sub(load(p.oz + g), set(plane)));
    hn::Store(zeta, d, zetas + g);
    const RV from = hn::Add(zeta, load(p.s_near + g)), to = hn::Add(zeta, load(p.s_far + g));
    start = hn::Min(start, hn::IfThenElse(on, from, infinity));
    end = hn::Max(end, hn::IfThenElse(on, to, hn::Neg(infinity)));
  }
  Beam beam;
  beam.z_low = plane - pad;
  beam.z_high = plane + pad;
  const FourLanes ends = least4(start, hn::Neg(end), start, hn::Neg(end));
  beam.start = ends.lane[0] - pad;
  beam.end = pad - ends.lane[1];
  const float length = beam.end > 0 ? beam.end : 0;
  const Spread x = spread_of(lanes, p.ox, p.shear_x, mirrored, zetas, length);
  const Spread y = spread_of(lanes, p.oy, p.shear_y, mirrored, zetas, length);
  const FourLanes low = least4(x.low, x.low_end, y.low, y.low_end);
  const FourLanes high = greatest4(x.high, x.high_end, y.high, y.high_end);
  const float per_length = length > 0 ? 1 / length : 0;
  const auto plane_of = [&](const FourLanes& f, int axis, float grown) {
    const float at = f.lane[2 * axis], last = f.lane[2 * axis + 1];
    return BeamPlane{at + grown, inverse_slope((last - at) * per_length)};
  };
  beam.x_low = plane_of(low, 0, -pad);
  beam.x_high = plane_of(high, 0, pad);
  beam.y_low = plane_of(low, 1, -pad);
  beam.y_high = plane_of(high, 1, pad);
  return beam;
}
