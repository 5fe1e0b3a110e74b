// Bundles of rays: filled, and tested with boxes. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

/// Two planes of a box, the one that rays of a quarter meet first and the other.
struct PlanePair {
  float near, far;
};

/// Where the bundle's lanes from `g` on are inside a box: from `near` to `far`, clipped to what
/// they look for.
HWY_INLINE void clip_to_box(const RayBundle& p, std::size_t g, PlanePair x, PlanePair y,
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

/// The rays of `bundle` that meet a child's box within [s_near, s_far], as bits.
HWY_INLINE std::uint32_t rays_in_child(const RayBundle& p, const BvhNode& n, std::uint32_t c) {
  const Rays d;
  std::uint32_t bits = 0;
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    RV near, far;
    clip_to_box(p, g, {n.bound[p.near_x][c], n.bound[p.far_x][c]},
                {n.bound[p.near_y][c], n.bound[p.far_y][c]},
                {n.bound[p.near_z][c], n.bound[p.far_z][c]}, &near, &far);
    bits |= bits_of(d, hn::Le(near, far)) << g;
  }
  return bits;
}

/// `raysheaf::past`, in lanes.
HWY_INLINE RV past(RV t, RV along, float pad) {
  return hn::Add(hn::Mul(hn::Mul(hn::Add(t, set(kLeastStep)), along), set(1 + 8 * kUnitRoundoff)),
                 set(pad));
}

/// Rays in lanes, along a quarter's axes.
struct RayLanes {
  RV ox, oy, oz, dx, dy, dz, t_min, t_limit;
};

/// Unused lanes look for nothing.
HWY_INLINE RayLanes gather_lanes(const Ray* rays, const std::uint32_t* index, RM used,
                                 const QuarterAxes& axes) {
  RV o[3], d[3], t_min, t_max;
  gather4(rays, 0, index, o[0], o[1], o[2], t_min);
  gather4(rays, 1, index, d[0], d[1], d[2], t_max);
  return {o[axes.axis_x], o[axes.axis_y], o[axes.axis_z], d[axes.axis_x],
          d[axes.axis_y], d[axes.axis_z], t_min,          hn::IfThenElse(used, t_max, set(-1))};
}

/// No less than kLeastStep times |d_z|, and always a normal number: processors take a hundred
/// cycles and more for a product that is not, and where t_min is 0 there would be one in every ray.
HWY_INLINE RV least_step_of(RV along) {
  static_assert(kLeastStep == 0x1p-148f);
  return hn::Mul(hn::Mul(hn::Max(along, set(0x1p23f)), set(0x1p-100f)), set(0x1p-48f));
}

/// What follows from rays in lanes, as in RayBundle.
struct SlabLanes {
  RV shear_x, shear_y, shear_z, along, per_x, per_y, s_near, s_far;

  HWY_INLINE SlabLanes(const RayLanes& r, bool mirrored, float slack) {
    using hn::Mul, hn::Sub;
    const Rays d;
    const RV pad = set(slack);
    along = hn::Abs(r.dz);
    const RV step = least_step_of(along);
    shear_x = hn::Div(r.dx, r.dz);
    shear_y = hn::Div(r.dy, r.dz);
    shear_z = hn::Div(set(1), r.dz);
    per_x = inverse_slope(mirrored ? hn::Neg(shear_x) : shear_x);
    per_y = inverse_slope(mirrored ? hn::Neg(shear_y) : shear_y);
    const RV bounding = hn::IfThenElseZero(hn::Lt(r.t_min, set(kLargeStart)), r.t_min);
    const RV far =
        hn::Add(hn::Add(Mul(Mul(r.t_limit, along), set(1 + 8 * kUnitRoundoff)), step), pad);
    s_near = Sub(Sub(Mul(Mul(bounding, along), set(1 - 8 * kUnitRoundoff)), step), pad);
    s_far = hn::IfThenElse(hn::Lt(r.t_limit, hn::Zero(d)),
                           set(-std::numeric_limits<float>::infinity()), far);
  }

  /// Clips each ray to the scene's box; returns the lanes that meet it. The others look no further.
  HWY_INLINE RM clip(const Box& scene, const RayLanes& r, const QuarterAxes& a, float slack) {
    using hn::Max, hn::Min, hn::Mul, hn::Sub;
    const float bound[6] = {scene.min.x, scene.min.y, scene.min.z,
                            scene.max.x, scene.max.y, scene.max.z};
    const RV pad = set(slack);
    // Lower planes move down as the origin moves up; which are near, the rows say.
    const auto from = [&](RV o, int row)
                          HWY_ATTR { return row < 3 ? hn::Add(o, pad) : Sub(o, pad); };
    const auto at = [&](RV o, int row) HWY_ATTR { return Sub(set(bound[row]), from(o, row)); };
    const RV z0 = at(r.oz, a.near_z), z1 = at(r.oz, a.far_z);
    const RV near = Max(Max(Mul(at(r.ox, a.near_x), per_x), Mul(at(r.oy, a.near_y), per_y)),
                        Max(a.mirrored ? hn::Neg(z0) : z0, s_near));
    const RV far = Min(Min(Mul(at(r.ox, a.far_x), per_x), Mul(at(r.oy, a.far_y), per_y)),
                       Min(a.mirrored ? hn::Neg(z1) : z1, s_far));
    const RM meets = hn::Le(near, far);
    // The quotients' three roundings, and those of the additions to come.
    const RV rounding = set(8 * kUnitRoundoff);
    s_near = Sub(near, Mul(hn::Abs(near), rounding));
    s_far = hn::IfThenElse(meets, hn::Add(far, Mul(hn::Abs(far), rounding)),
                           set(-std::numeric_limits<float>::infinity()));
    return meets;
  }
};

struct PreparedLanes {
  std::uint32_t lanes;  ///< those that meet the scene's box
  float pad;
  bool bounded;
};

/// Prepares the rays of a bundle, of which `index` has kBundleWidth and `count` are used. Calls
/// `keep(g, rays, slabs)` for the lanes from g on.
template <class Keep>
HWY_INLINE PreparedLanes prepare_lanes(const Ray* rays, const std::uint32_t* index,
                                       std::uint32_t count, const Box& scene,
                                       const QuarterAxes& axes, const Keep& keep) {
  using hn::Abs, hn::Max, hn::Sub;
  const Rays d;
  constexpr std::size_t kGroups = kBundleWidth / hn::MaxLanes(Rays());
  RayLanes groups[kGroups];
  RV reach = hn::Zero(d), coordinate = hn::Zero(d);
  const auto grow = [&](RV o, int axis) HWY_ATTR {
    reach = Max(reach, Max(Abs(Sub(o, set(component(scene.min, axis)))),
                           Abs(Sub(o, set(component(scene.max, axis))))));
    coordinate = Max(coordinate, Abs(o));
  };
  for (std::size_t n = 0; n < kGroups; ++n) {
    const std::size_t g = n * ray_lanes();
    groups[n] = gather_lanes(rays, index + g,
                             lanes_of(count < kBundleWidth ? (1u << count) - 1 : 0xffffu, g), axes);
    grow(groups[n].ox, axes.axis_x);
    grow(groups[n].oy, axes.axis_y);
    grow(groups[n].oz, axes.axis_z);
  }
  const float size = 2 * hn::GetLane(hn::MaxOfLanes(d, reach));
  const float largest = hn::GetLane(hn::MaxOfLanes(d, coordinate)) + size;
  PreparedLanes prepared{0, 128 * kUnitRoundoff * size + 8 * kUnitRoundoff * largest + kTinySlack,
                         largest <= kLargestBounded};
  for (std::size_t n = 0; n < kGroups; ++n) {
    const std::size_t g = n * ray_lanes();
    SlabLanes slabs(groups[n], axes.mirrored, prepared.pad);
    if (HWY_LIKELY(prepared.bounded))
      prepared.lanes |= bits_of(d, slabs.clip(scene, groups[n], axes, prepared.pad)) << g;
    keep(g, groups[n], slabs);
  }
  return prepared;
}

/// `count` numbers; missing ones of kBundleWidth repeat the first.
HWY_INLINE void copy_numbers(const std::uint32_t* from, std::uint32_t count, std::uint32_t* to) {
  if (HWY_LIKELY(count == kBundleWidth)) {
    std::memcpy(to, from, kBundleWidth * sizeof *to);
  } else {
    for (std::uint32_t i = 0; i < kBundleWidth; ++i) to[i] = from[i < count ? i : 0];
  }
}

/// Fills a bundle with `count` rays of the order; missing ones repeat the first. Returns the lanes
/// that meet the scene's box.
HWY_INLINE std::uint32_t fill_bundle(const Ray* rays, const std::uint32_t* order,
                                     std::uint32_t count, std::uint32_t quarter, const Box& scene,
                                     RayBundle* p) {
  static_cast<QuarterAxes&>(*p) = QuarterAxes(quarter);
  p->count = count;
  copy_numbers(order, count, p->index);
  const PreparedLanes prepared = prepare_lanes(
      rays, p->index, count, scene, *p,
      [&](std::size_t g, const RayLanes& r, const SlabLanes& s) HWY_ATTR {
        const Rays d;
        const auto put = [&](RV v, float* to) HWY_ATTR { hn::Store(v, d, to + g); };
        put(r.ox, p->ox), put(r.oy, p->oy), put(r.oz, p->oz);
        put(r.t_min, p->t_min), put(r.t_limit, p->t_limit);
        put(s.shear_x, p->shear_x), put(s.shear_y, p->shear_y), put(s.shear_z, p->shear_z);
        put(s.along, p->along), put(s.per_x, p->per_x), put(s.per_y, p->per_y);
        put(s.s_near, p->s_near), put(s.s_far, p->s_far);
        put(r.t_limit, p->t_low);
        const RayInts di;
        hn::Store(hn::Set(di, kInvalidId), di, p->place + g);
      });
  p->pad = prepared.pad;
  p->bounded = prepared.bounded;
  const RV pad = set(p->pad);
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const Rays d;
    const auto widen = [&](const float* o, int near_row, float* near, float* far) HWY_ATTR {
      const RV grown = near_row < 3 ? pad : hn::Neg(pad);
      hn::Store(hn::Add(load(o + g), grown), d, near + g);
      hn::Store(hn::Sub(load(o + g), grown), d, far + g);
    };
    widen(p->ox, p->near_x, p->x_near, p->x_far);
    widen(p->oy, p->near_y, p->y_near, p->y_far);
    widen(p->oz, p->near_z, p->z_near, p->z_far);
  }
  return prepared.lanes;
}
