// The beam of a packet: made, and tested with boxes. Included once a SIMD target by
// dual/trace_simd.cpp, inside its namespace.

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
/// RayPacket or Stream.
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
HWY_INLINE float farthest_zeta(const RayPacket& p) {
  const Rays d;
  RV far = hn::Set(d, -std::numeric_limits<float>::infinity());
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes())
    far = hn::Max(far, hn::Add(load(p.zeta + g), load(p.s_far + g)));
  return hn::GetLane(hn::MaxOfLanes(d, far));
}
HWY_INLINE float least(RV v) {
  return hn::GetLane(hn::MinOfLanes(Rays(), v));
}
HWY_INLINE float greatest(RV v) {
  return hn::GetLane(hn::MaxOfLanes(Rays(), v));
}

/// The two planes that bound x between zeta = 0 and `length` for the lanes that are set.
HWY_INLINE void make_planes(std::uint32_t lanes, const RayPacket& p, const float* o,
                            const float* shear, float length, BeamPlane* low, BeamPlane* high) {
  const Rays d;
  const RV infinity = set(std::numeric_limits<float>::infinity());
  RV a0 = infinity, a1 = hn::Neg(infinity), b0 = a0, b1 = a1;
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    const RM on = lanes_of(lanes, g);
    const RV across = load(shear + g), slope = p.mirrored ? hn::Neg(across) : across;
    const RV zeta = load(p.zeta + g);
    const RV a = hn::Sub(load(o + g), hn::Mul(slope, zeta));
    const RV b = hn::Add(load(o + g), hn::Mul(slope, hn::Sub(set(length), zeta)));
    a0 = hn::Min(a0, hn::IfThenElse(on, a, infinity));
    b0 = hn::Min(b0, hn::IfThenElse(on, b, infinity));
    a1 = hn::Max(a1, hn::IfThenElse(on, a, hn::Neg(infinity)));
    b1 = hn::Max(b1, hn::IfThenElse(on, b, hn::Neg(infinity)));
  }
  (void)d;
  const float per_length = length > 0 ? 1 / length : 0;
  const float low_a = least(a0), high_a = greatest(a1);
  *low = {low_a - p.pad, inverse_slope((least(b0) - low_a) * per_length)};
  *high = {high_a + p.pad, inverse_slope((greatest(b1) - high_a) * per_length)};
}

/// The beam of the lanes that are set: at least one.
HWY_INLINE Beam make_beam(std::uint32_t lanes, RayPacket* p) {
  const Rays d;
  const float sign = p->mirrored ? -1.0f : 1.0f;
  const float first = p->oz[__builtin_ctz(lanes)];
  const RV infinity = set(std::numeric_limits<float>::infinity());
  RV nearest = infinity;
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    const RV start =
        hn::Add(hn::Mul(set(sign), hn::Sub(load(p->oz + g), set(first))), load(p->s_near + g));
    nearest = hn::Min(nearest, hn::IfThenElse(lanes_of(lanes, g), start, infinity));
  }
  const float plane = first + sign * least(nearest);
  RV start = infinity, end = hn::Neg(infinity);
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    const RM on = lanes_of(lanes, g);
    const RV zeta = hn::Mul(set(sign), hn::Sub(load(p->oz + g), set(plane)));
    hn::Store(zeta, d, p->zeta + g);
    const RV from = hn::Add(zeta, load(p->s_near + g)), to = hn::Add(zeta, load(p->s_far + g));
    start = hn::Min(start, hn::IfThenElse(on, from, infinity));
    end = hn::Max(end, hn::IfThenElse(on, to, hn::Neg(infinity)));
  }
  Beam beam;
  beam.z_low = plane - p->pad;
  beam.z_high = plane + p->pad;
  beam.start = least(start) - p->pad;
  beam.end = greatest(end) + p->pad;
  const float length = beam.end > 0 ? beam.end : 0;
  make_planes(lanes, *p, p->ox, p->shear_x, length, &beam.x_low, &beam.x_high);
  make_planes(lanes, *p, p->oy, p->shear_y, length, &beam.y_low, &beam.y_high);
  return beam;
}
