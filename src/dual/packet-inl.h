// Packets of rays: filled, and tested with boxes. Included once a SIMD target by
// dual/trace_simd.cpp, inside its namespace.

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
  if (count == kPacketWidth) {
    std::memcpy(p->index, order, sizeof p->index);
  } else {
    for (std::uint32_t i = 0; i < kPacketWidth; ++i) p->index[i] = order[i < count ? i : 0];
  }
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
