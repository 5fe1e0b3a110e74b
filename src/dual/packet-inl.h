// The packet kernels: filling a packet, its beam, and its tests with boxes and triangles. Included
// once a SIMD target by dual/trace_simd.cpp, inside its namespace.

using Rays = hn::CappedTag<float, kPacketWidth>;
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

/// Reads no more bytes than were written, so that the load is forwarded from the store.
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
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits >> g),
                                 static_cast<std::uint8_t>(bits >> (g + 8 < 32 ? g + 8 : 31))};
  return hn::LoadMaskBits(d, bytes);
}

/// Clamps away from zero, keeping the sign, so that the inverse is finite.
HWY_INLINE RV inverse_slope(RV slope) {
  const RV tiny = set(1e-20f);
  const RV safe = hn::Max(hn::Abs(slope), tiny);
  return hn::Div(hn::CopySign(set(1), slope), safe);
}
inline float inverse_slope(float slope) {
  const float size = std::fabs(slope) > 1e-20f ? std::fabs(slope) : 1e-20f;
  return std::copysign(1.0f, slope) / size;
}

/// Two planes of a box, the one that rays of a quarter meet first and the other.
struct PlanePair {
  float near, far;
};

/// Where the packet's lanes from `g` on are inside a box: from `near` to `far`, clipped to what
/// they look for.
HWY_INLINE void clip_to_box(const RayPacket& p, std::size_t g, PlanePair x, PlanePair y,
                            PlanePair z, RV* near, RV* far) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  const RV per_x = load(p.per_x + g), per_y = load(p.per_y + g);
  const RV x0 = Mul(Sub(set(x.near), load(p.x_near + g)), per_x);
  const RV x1 = Mul(Sub(set(x.far), load(p.x_far + g)), per_x);
  const RV y0 = Mul(Sub(set(y.near), load(p.y_near + g)), per_y);
  const RV y1 = Mul(Sub(set(y.far), load(p.y_far + g)), per_y);
  const RV from = load(p.z_near + g), to = load(p.z_far + g);
  const RV z0 = p.mirrored ? Sub(from, set(z.near)) : Sub(set(z.near), from);
  const RV z1 = p.mirrored ? Sub(to, set(z.far)) : Sub(set(z.far), to);
  *near = Max(Max(x0, y0), Max(z0, load(p.s_near + g)));
  *far = Min(Min(x1, y1), Min(z1, load(p.s_far + g)));
}

/// The rays of `packet` that meet a child's box within [s_near, s_far], as bits.
HWY_INLINE std::uint32_t rays_in_child(const RayPacket& p, const BvhNode& n, std::uint32_t c) {
  const Rays d;
  std::uint32_t bits = 0;
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    RV near, far;
    clip_to_box(p, g, {n.bound[p.near_x][c], n.bound[p.far_x][c]},
                {n.bound[p.near_y][c], n.bound[p.far_y][c]},
                {n.bound[p.near_z][c], n.bound[p.far_z][c]}, &near, &far);
    bits |= bits_of(d, hn::Le(near, far)) << g;
  }
  return bits;
}

/// The children whose boxes the beam meets, as bits; `near` takes where it enters them.
HWY_INLINE std::uint32_t children_in_beam(const RayPacket& p, const Beam& b, const BvhNode& n,
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

/// Four floats of a record each for as many records as a vector has lanes: field k of list[i] comes
/// to lane i of fk. In registers: what was stored in parts cannot be loaded whole at once.
template <class Record>
HWY_INLINE void gather4(const Record* records, int half, const std::uint32_t* list, RV& f0, RV& f1,
                        RV& f2, RV& f3) {
  static_assert(sizeof(Record) == 32);
  const Rays d;
  const auto at = [&](std::size_t i) {
    return reinterpret_cast<const float*>(records + list[i]) + 4 * half;
  };
#if HWY_TARGET == HWY_SCALAR
  const float* from = at(0);
  f0 = hn::Set(d, from[0]);
  f1 = hn::Set(d, from[1]);
  f2 = hn::Set(d, from[2]);
  f3 = hn::Set(d, from[3]);
#else
  // Vector j has the records j, 4 + j, 8 + j, ... in its blocks of four lanes.
  const auto blocks = [&](std::size_t j) __attribute__((always_inline)) {
    if constexpr (hn::MaxLanes(Rays()) == 16) {
      const hn::Half<Rays> d8;
      const hn::Half<hn::Half<Rays> > d4;
      return hn::Combine(d, hn::Combine(d8, hn::LoadU(d4, at(12 + j)), hn::LoadU(d4, at(8 + j))),
                         hn::Combine(d8, hn::LoadU(d4, at(4 + j)), hn::LoadU(d4, at(j))));
    } else if constexpr (hn::MaxLanes(Rays()) == 8) {
      const hn::Half<Rays> d4;
      return hn::Combine(d, hn::LoadU(d4, at(4 + j)), hn::LoadU(d4, at(j)));
    } else {
      return hn::LoadU(d, at(j));
    }
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

/// Copies `count` rays of the order into lanes; missing ones repeat the first. `dx` to `dz`: their
/// directions along the packet's axes.
HWY_INLINE void gather_rays(const Ray* rays, const std::uint32_t* order, std::uint32_t count,
                            std::uint32_t quarter, RayPacket* p, float* dx, float* dy, float* dz) {
  const int along = static_cast<int>(quarter / 8), next = along == 2 ? 0 : along + 1;
  const int last = next == 2 ? 0 : next + 1;
  p->mirrored = (quarter & 4) != 0;
  p->axis_x = p->mirrored ? last : next;
  p->axis_y = p->mirrored ? next : last;
  p->axis_z = along;
  const bool left = (quarter & (p->mirrored ? 1 : 2)) != 0;
  const bool down = (quarter & (p->mirrored ? 2 : 1)) != 0;
  p->near_x = p->axis_x + (left ? 3 : 0);
  p->far_x = p->axis_x + (left ? 0 : 3);
  p->near_y = p->axis_y + (down ? 3 : 0);
  p->far_y = p->axis_y + (down ? 0 : 3);
  p->near_z = along + (p->mirrored ? 3 : 0);
  p->far_z = along + (p->mirrored ? 0 : 3);
  p->count = count;
  for (std::uint32_t i = 0; i < kPacketWidth; ++i) p->index[i] = order[i < count ? i : 0];
  const Rays d;
  float* const origin[3] = {p->axis_x == 0   ? p->ox
                            : p->axis_y == 0 ? p->oy
                                             : p->oz,
                            p->axis_x == 1   ? p->ox
                            : p->axis_y == 1 ? p->oy
                                             : p->oz,
                            p->axis_x == 2   ? p->ox
                            : p->axis_y == 2 ? p->oy
                                             : p->oz};
  float* const direction[3] = {p->axis_x == 0   ? dx
                               : p->axis_y == 0 ? dy
                                                : dz,
                               p->axis_x == 1   ? dx
                               : p->axis_y == 1 ? dy
                                                : dz,
                               p->axis_x == 2   ? dx
                               : p->axis_y == 2 ? dy
                                                : dz};
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    RV x, y, z, t;
    gather4(rays, 0, p->index + g, x, y, z, t);
    hn::Store(x, d, origin[0] + g);
    hn::Store(y, d, origin[1] + g);
    hn::Store(z, d, origin[2] + g);
    hn::Store(t, d, p->t_min + g);
    gather4(rays, 1, p->index + g, x, y, z, t);
    hn::Store(x, d, direction[0] + g);
    hn::Store(y, d, direction[1] + g);
    hn::Store(z, d, direction[2] + g);
    const RM used = lanes_of(count < kPacketWidth ? (1u << count) - 1 : 0xffffu, g);
    hn::Store(hn::IfThenElse(used, t, set(-1)), d, p->t_limit + g);
  }
}

/// Everything that follows from the rays and the scene's box.
HWY_INLINE void prepare_packet(const Box& scene, const float* dx, const float* dy, const float* dz,
                               RayPacket* p) {
  using hn::Abs, hn::Max, hn::Mul, hn::Sub;
  const Rays d;
  const Vec3 lo{component(scene.min, p->axis_x), component(scene.min, p->axis_y),
                component(scene.min, p->axis_z)};
  const Vec3 hi{component(scene.max, p->axis_x), component(scene.max, p->axis_y),
                component(scene.max, p->axis_z)};
  RV reach = hn::Zero(d), coordinate = hn::Zero(d);
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    const auto grow = [&](const float* o, float low, float high) {
      const RV at = load(o + g);
      reach = Max(reach, Max(Abs(Sub(at, set(low))), Abs(Sub(at, set(high)))));
      coordinate = Max(coordinate, Abs(at));
    };
    grow(p->ox, lo.x, hi.x);
    grow(p->oy, lo.y, hi.y);
    grow(p->oz, lo.z, hi.z);
  }
  const float size = 2 * hn::GetLane(hn::MaxOfLanes(d, reach));
  const float largest = hn::GetLane(hn::MaxOfLanes(d, coordinate)) + size;
  p->bounded = largest <= kLargestBounded;
  p->pad = 128 * kUnitRoundoff * size + 8 * kUnitRoundoff * largest + kTinySlack;
  const RV pad = set(p->pad), infinity = set(std::numeric_limits<float>::infinity());
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    const RV z = load(dz + g), along = Abs(z);
    const RV shear_x = hn::Div(load(dx + g), z), shear_y = hn::Div(load(dy + g), z);
    hn::Store(shear_x, d, p->shear_x + g);
    hn::Store(shear_y, d, p->shear_y + g);
    hn::Store(hn::Div(set(1), z), d, p->shear_z + g);
    hn::Store(along, d, p->along + g);
    hn::Store(inverse_slope(p->mirrored ? hn::Neg(shear_x) : shear_x), d, p->per_x + g);
    hn::Store(inverse_slope(p->mirrored ? hn::Neg(shear_y) : shear_y), d, p->per_y + g);
    // Lower planes move down as the origin moves up; which are near, the rows say.
    const auto widen = [&](const float* o, int near_row, float* near, float* far) {
      const RV grown = near_row < 3 ? pad : hn::Neg(pad);
      hn::Store(hn::Add(load(o + g), grown), d, near + g);
      hn::Store(Sub(load(o + g), grown), d, far + g);
    };
    widen(p->ox, p->near_x, p->x_near, p->x_far);
    widen(p->oy, p->near_y, p->y_near, p->y_far);
    widen(p->oz, p->near_z, p->z_near, p->z_far);
    const RV limit = load(p->t_limit + g);
    const RV least = set(kLeastStep), start = load(p->t_min + g);
    const RV bounding = hn::IfThenElseZero(hn::Lt(start, set(kLargeStart)), start);
    const RV far = hn::Add(Mul(Mul(hn::Add(limit, least), along), set(1 + 8 * kUnitRoundoff)), pad);
    const RV near = Sub(Mul(Mul(Sub(bounding, least), along), set(1 - 8 * kUnitRoundoff)), pad);
    hn::Store(near, d, p->s_near + g);
    hn::Store(hn::IfThenElse(hn::Lt(limit, hn::Zero(d)), hn::Neg(infinity), far), d, p->s_far + g);
    hn::Store(infinity, d, p->t + g);
    hn::Store(hn::Zero(d), d, p->u + g);
    hn::Store(hn::Zero(d), d, p->v + g);
    const RayInts di;
    hn::Store(hn::Set(di, kInvalidId), di, p->id + g);
  }
}

/// Clips each ray to the scene's box; returns the lanes that meet it. The others look no further.
HWY_INLINE std::uint32_t clip_to_scene(const Box& scene, RayPacket* p) {
  const Rays d;
  const float bound[6] = {scene.min.x, scene.min.y, scene.min.z,
                          scene.max.x, scene.max.y, scene.max.z};
  const RV nowhere = set(-std::numeric_limits<float>::infinity());
  std::uint32_t lanes = 0;
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    RV near, far;
    clip_to_box(*p, g, {bound[p->near_x], bound[p->far_x]}, {bound[p->near_y], bound[p->far_y]},
                {bound[p->near_z], bound[p->far_z]}, &near, &far);
    const RM meets = hn::Le(near, far);
    lanes |= bits_of(d, meets) << g;
    // The quotients' three roundings, and those of the additions to come.
    const RV slack = set(8 * kUnitRoundoff);
    hn::Store(hn::Sub(near, hn::Mul(hn::Abs(near), slack)), d, p->s_near + g);
    hn::Store(hn::IfThenElse(meets, hn::Add(far, hn::Mul(hn::Abs(far), slack)), nowhere), d,
              p->s_far + g);
  }
  return lanes;
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
