// Rays that all start at one point, as those of a point light or a camera do: what depends only on
// the point is computed once for all of them. Shadow rays take 1.2 times as long without this way.
// Included by methods/dual/trace_simd.cpp, inside its namespace.
//
//   the start      the scene's box from there: once for a stream
//   a triangle     three planes through the start and one edge each, and the triangle's own plane:
//                  once for all bundles at its leaf
//   a ray          is on one side of all three planes if it meets the triangle
//
// Edge functions (intersect/triangle_body.h) are linear in the slopes x and y of a ray. With the
// corners A, B, C as seen from the start, U = (C x B) . (x, y, 1), and likewise V and W; their sum
// is n . (x, y, 1) with n = (B - A) x (A - C), and t = n . A / (n . d).

/// The start that rays share, along the axes of their quarter.
struct SharedStart {
  Vec3 origin;
  float t_min;

  SharedStart(const Ray& ray, const QuarterAxes& axes)
      : origin(axes.along_axes(ray.origin)), t_min(ray.t_min) {}
};

/// `prepare_lanes` for rays of a shared start. `box`: the scene's, from there.
template <class Keep>
HWY_INLINE std::uint32_t prepare_from_start(const SharedStart& start, const BoxFromOrigins& box,
                                            const QuarterAxes& axes, const Ray* rays,
                                            const std::uint32_t* index, std::uint32_t count,
                                            const Keep& keep) {
  std::uint32_t lanes = 0;
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const RM used = lanes_of(count < kBundleWidth ? (1u << count) - 1 : 0xffffu, g);
    RV d[3], t_max;
    gather4(rays, 1, index + g, d[0], d[1], d[2], t_max);
    const RayLanes r{set(start.origin.x), set(start.origin.y),
                     set(start.origin.z), d[axes.axis_x],
                     d[axes.axis_y],      d[axes.axis_z],
                     set(start.t_min),    hn::IfThenElse(used, t_max, set(-1))};
    SlabLanes slabs(r, axes.mirrored);
    lanes |= bits_of(Rays(), slabs.clip(box, axes.mirrored)) << g;
    keep(g, r, slabs);
  }
  return lanes;
}

/// `make_beam` for rays of a shared start, where all planes across begin.
HWY_INLINE Beam make_beam_from_start(const SharedStart& start, std::uint32_t lanes,
                                     const StreamBundle& b, bool mirrored, const Growth& growth) {
  const RV infinity = set(std::numeric_limits<float>::infinity());
  RV least_x = infinity, least_y = infinity, most_x = infinity, most_y = infinity;
  RV from = infinity, to = infinity;
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
    const RM on = lanes_of(lanes, g);
    const auto lower = [&](RV* least, RV v)
                           HWY_ATTR { *least = hn::Min(*least, hn::IfThenElse(on, v, infinity)); };
    const RV x = load(b.shear_x + g), y = load(b.shear_y + g);
    lower(&least_x, mirrored ? hn::Neg(x) : x), lower(&most_x, mirrored ? x : hn::Neg(x));
    lower(&least_y, mirrored ? hn::Neg(y) : y), lower(&most_y, mirrored ? y : hn::Neg(y));
    lower(&from, load(b.s_near + g)), lower(&to, hn::Neg(load(b.s_far + g)));
  }
  const FourLanes slopes = least4(least_x, most_x, least_y, most_y);
  const FourLanes ends = least4(from, to, from, to);
  const Vec3 o = start.origin;
  const float pad = beam_pad(max_component(abs(o)), 0, ends.lane[0], growth);
  Beam beam;
  beam.z_low = o.z - pad, beam.z_high = o.z + pad;
  beam.start = ends.lane[0] - pad, beam.end = pad - ends.lane[1];
  beam.x_low = beam_plane(o.x, slopes.lane[0], -1, pad);
  beam.x_high = beam_plane(o.x, -slopes.lane[1], 1, pad);
  beam.y_low = beam_plane(o.y, slopes.lane[2], -1, pad);
  beam.y_high = beam_plane(o.y, -slopes.lane[3], 1, pad);
  return beam;
}

/// The planes of a quad's triangles, by triangle. They are computed in binary64 and rounded once.
///
/// Errors, with u = 2^-24. Let T be the sum of a plane's three magnitudes. Rounding the plane and
/// the slopes, two products and two sums give at most 5 u T; 6 u T covers terms of second order.
/// Binary64 adds at most 2^-48 times the product of the largest extent q and the largest coordinate
/// M for a plane of an edge, 2^-48 q^2 for the triangle's plane, and 2^-46 q^2 M for n . A.
/// Products that underflow add less than 2^-140; from T = 2^120 on sums may overflow, and the error
/// is infinite.
struct QuadFromOrigin {
  float u[3][4], v[3][4], w[3][4], error[4];
  float normal[3][4], normal_error[4];       ///< a third more, because it divides
  float volume[4], volume_error[4];          ///< n . A
  double wide_normal[3][4], wide_volume[4];  ///< not rounded
  double det_off[4], volume_off[4];          ///< as in intersect/plane.h, for rounded slopes

  HWY_INLINE QuadFromOrigin(const TriangleQuad& quad, const QuarterAxes& axes, Vec3 origin) {
    using hn::Abs, hn::Add, hn::Max, hn::Mul;
    using Doubles = hn::CappedTag<double, kQuadTriangles>;
    const Doubles d;
    const hn::Rebind<float, Doubles> df;
    using Lanes = hn::Vec<Doubles>;
    using Three = Lanes3<Lanes>;
    const auto sum = [](const Three& p) HWY_ATTR { return Add(Add(Abs(p.x), Abs(p.y)), Abs(p.z)); };
    const Three start = all3(d, origin);
    const Lanes tiny = hn::Set(d, 0x1p-140);
    const Lanes infinite = hn::Set(d, std::numeric_limits<double>::infinity());
    // Infinite, where the scalar target of Highway would store the largest float.
    const auto put = [&](Lanes value, float* to) HWY_ATTR {
      const auto rounded = hn::DemoteTo(df, value);
      const auto too_large = hn::Gt(hn::Abs(rounded), hn::Set(df, 0x1p126f));
      const auto infinity = hn::Set(df, std::numeric_limits<float>::infinity());
      hn::Store(hn::IfThenElse(too_large, hn::CopySign(infinity, rounded), rounded), df, to);
    };
    for (std::size_t g = 0; g < kQuadTriangles; g += hn::Lanes(d)) {
      const auto corner = [&](int c) HWY_ATTR {
        const auto along = [&](int axis) HWY_ATTR {
          return hn::PromoteTo(d, hn::Load(df, quad.vertex[c][axis] + g));
        };
        return Three{along(axes.axis_x), along(axes.axis_y), along(axes.axis_z)};
      };
      const Three pa = corner(0), pb = corner(1), pc = corner(2);
      const Three ab = minus(pb, pa), bc = minus(pc, pb), ca = minus(pa, pc);
      const Three a = minus(pa, start), b = minus(pb, start), c = minus(pc, start);
      const Three of_u = cross(bc, b), of_v = cross(ca, c), of_w = cross(ab, a), n = cross(ab, ca);
      const auto keep = [&](const Three& plane, float(&to)[3][4]) HWY_ATTR {
        put(plane.x, to[0] + g), put(plane.y, to[1] + g), put(plane.z, to[2] + g);
      };
      keep(of_u, u), keep(of_v, v), keep(of_w, w), keep(n, normal);
      const Lanes q = Max(Max(largest(ab), largest(bc)), largest(ca));
      const Lanes m = Max(Max(largest(a), largest(b)), largest(c));
      const auto error_of = [&](double roundings, Lanes of_plane, Lanes product) HWY_ATTR {
        const Lanes rounding = Mul(hn::Set(d, roundings * kUnitRoundoff), of_plane);
        const Lanes sum_of = Add(Add(rounding, Mul(hn::Set(d, 0x1p-48), product)), tiny);
        return hn::IfThenElse(hn::Lt(of_plane, hn::Set(d, 0x1p120)), sum_of, infinite);
      };
      const Lanes of_edges = Max(Max(sum(of_u), sum(of_v)), sum(of_w));
      put(error_of(6, of_edges, Mul(q, m)), error + g);
      put(error_of(8, sum(n), Mul(q, q)), normal_error + g);
      const Lanes n_a = dot(n, a);
      put(n_a, volume + g);
      const auto put_wide = [&](Lanes value, double* to) HWY_ATTR { hn::Store(value, d, to + g); };
      put_wide(n.x, wide_normal[0]), put_wide(n.y, wide_normal[1]);
      put_wide(n.z, wide_normal[2]), put_wide(n_a, wide_volume);
      put_wide(Add(Mul(hn::Set(d, 0x1p-47), Mul(q, q)),
                   Mul(hn::Set(d, Plane::kRounding), Add(Abs(n.x), Abs(n.y)))),
               det_off);
      put_wide(Mul(hn::Set(d, 0x1.03p-46), Mul(Mul(q, q), m)), volume_off);
      put(Add(Mul(hn::Set(d, 0x1p-46), Mul(Mul(q, q), m)), hn::Set(d, 0x1p-149)), volume_error + g);
    }
  }
};

/// The lanes of a bundle from `g` on that triangle `k` of a quad is surely beyond
/// (intersect/plane.h), as bits.
inline HWY_NOINLINE std::uint32_t lanes_beyond_from_origin(const QuadFromOrigin& q, std::uint32_t k,
                                                           const StreamBundle& b, std::size_t g) {
  using hn::Add, hn::Mul;
  using Doubles = hn::CappedTag<double, kBundleWidth>;
  const Doubles d;
  const hn::Rebind<float, Doubles> df;
  const auto all = [&](double x) HWY_ATTR { return hn::Set(d, x); };
  std::uint32_t beyond = 0;
  for (std::size_t i = 0; i < ray_lanes(); i += hn::Lanes(d)) {
    const auto widened = [&](const float* from)
                             HWY_ATTR { return hn::PromoteTo(d, hn::Load(df, from + g + i)); };
    const auto det = Add(Add(Mul(all(q.wide_normal[0][k]), widened(b.shear_x)),
                             Mul(all(q.wide_normal[1][k]), widened(b.shear_y))),
                         all(q.wide_normal[2][k]));
    beyond |= beyond_plane(d, {det, all(q.det_off[k]), all(q.wide_volume[k]), all(q.volume_off[k])},
                           b.shear_z + g + i, b.t_min + g + i, b.t_limit + g + i)
              << i;
  }
  return beyond;
}

/// n . (x, y, 1) of triangle `k`.
HWY_INLINE RV value_of(const float (&plane)[3][4], std::uint32_t k, RV shear_x, RV shear_y) {
  return hn::Add(hn::Add(hn::Mul(shear_x, set(plane[0][k])), set(plane[2][k])),
                 hn::Mul(shear_y, set(plane[1][k])));
}

/// On which sides of the planes of a triangle's edges rays are.
struct EdgeSides {
  RV least, most, error;

  HWY_INLINE EdgeSides(const QuadFromOrigin& q, std::uint32_t k, RV shear_x, RV shear_y)
      : error(set(q.error[k])) {
    const RV u = value_of(q.u, k, shear_x, shear_y), v = value_of(q.v, k, shear_x, shear_y),
             w = value_of(q.w, k, shear_x, shear_y);
    least = hn::Min(hn::Min(u, v), w), most = hn::Max(hn::Max(u, v), w);
  }
  /// The lanes that certainly miss.
  [[nodiscard]] HWY_INLINE RM miss() const { return hn::Gt(hn::Min(hn::Neg(least), most), error); }
  /// The lanes whose line certainly hits.
  [[nodiscard]] HWY_INLINE RM around() const {
    return hn::Gt(hn::Max(least, hn::Neg(most)), error);
  }
};

/// The fields of rays of one origin for tests with triangles.
struct LeafRaysOfOrigin {
  RV shear_x, shear_y, shear_z, t_min, t_limit;
};

/// `test_lanes` for triangle `k` of a quad.
///
/// The error of t: 5 u t for roundings of n . A, 1 / d_z, the products and the quotient; 3 u t more
/// where 1 / d_z is below the normal numbers; 2 u t for the end of the interval and the rounding of
/// t itself. Together less than 11 u t.
HWY_INLINE Tested<Rays> test_from_origin(const QuadFromOrigin& q, std::uint32_t k,
                                         const LeafRaysOfOrigin& r) {
  using hn::Abs, hn::Add, hn::And, hn::Ge, hn::Gt, hn::Le, hn::Lt, hn::Mul, hn::Or;
  const RV det_error = set(q.normal_error[k]);
  const EdgeSides sides(q, k, r.shear_x, r.shear_y);
  const RV det = value_of(q.normal, k, r.shear_x, r.shear_y), size = Abs(det),
           per_det = hn::Div(set(1), det);
  const RV distance = Mul(set(q.volume[k]), r.shear_z), far = Abs(distance);
  const RV t = Mul(distance, per_det), per_size = Abs(per_det);
  const RV half = Add(Mul(Abs(t), Add(set(11 * kUnitRoundoff), Mul(det_error, per_size))),
                      Mul(Mul(set(q.volume_error[k]), Abs(r.shear_z)), per_size));
  Tested<Rays> tested;
  tested.low = hn::Sub(t, half);
  tested.high = Add(t, half);
  tested.det = det;
  const RM normal = And(And(And(Ge(size, set(kSmallDeterminant)), Le(size, set(kLargeDeterminant))),
                            Ge(size, Mul(set(4), det_error))),
                        And(And(Ge(far, set(kSmallDistance)), Le(far, set(kLargeDeterminant))),
                            Ge(half, set(kSmallInterval))));
  const RM within = And(Ge(tested.low, r.t_min), Le(tested.high, r.t_limit));
  const RM beyond = Or(Lt(tested.high, r.t_min), Gt(tested.low, r.t_limit));
  tested.hit = And(And(sides.around(), normal), within);
  const RM settled =
      Or(Or(tested.hit, And(normal, beyond)), Or(sides.miss(), Gt(r.t_min, r.t_limit)));
  tested.unsettled = hn::Not(settled);
  return tested;
}
