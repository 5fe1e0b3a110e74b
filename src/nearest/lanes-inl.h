// Boxes and triangles against one point, in lanes. Included once a SIMD target by
// nearest/nearest_simd.cpp, inside its namespace.

/// Points that go down the tree together, a lane each.
inline constexpr std::uint32_t kBundlePoints = 16;
using Lanes = hn::CappedTag<float, kBundlePoints>;
using LV = hn::Vec<Lanes>;
/// A quad's triangles for as many points as there is room for, on short vectors a part of them.
using Doubles = hn::CappedTag<double, 2 * kQuadTriangles>;
inline constexpr std::uint32_t kPointsAtOnce = hn::MaxLanes(Doubles()) > kQuadTriangles
                                                   ? hn::MaxLanes(Doubles()) / kQuadTriangles
                                                   : 1;
using Singles = hn::Rebind<float, Doubles>;
using DV = hn::Vec<Doubles>;

using DV3 = Lanes3<DV>;

HWY_INLINE DV clamped(DV x, DV low, DV high) {
  return hn::Min(hn::Max(x, low), high);
}
/// x where it is above 0, else 1: to divide by.
HWY_INLINE DV or_one(DV x) {
  const Doubles d;
  return hn::IfThenElse(hn::Gt(x, hn::Zero(d)), x, hn::Set(d, 1.0));
}

/// The square of `from_edge` (nearest/point_triangle_body.h), operation by operation.
HWY_INLINE DV squared_to_edge(const DV3& to_a, const DV3& to_b, const DV3& h) {
  const Doubles d;
  const DV3 w = plus(to_a, to_b);
  const DV t = hn::Div(dot(w, h), or_one(dot(h, h)));
  const auto at_b = hn::Ge(t, hn::Set(d, 1.0)), at_a = hn::Le(t, hn::Set(d, -1.0));
  const DV half = hn::Set(d, 0.5);
  const auto between = [&](DV sum, DV slope, DV a, DV b) HWY_ATTR {
    const DV r =
        clamped(hn::Mul(hn::Sub(sum, hn::Mul(t, slope)), half), hn::Min(a, b), hn::Max(a, b));
    return hn::IfThenElse(at_b, b, hn::IfThenElse(at_a, a, r));
  };
  const DV3 r{between(w.x, h.x, to_a.x, to_b.x), between(w.y, h.y, to_a.y, to_b.y),
              between(w.z, h.z, to_a.z, to_b.z)};
  return dot(r, r);
}

/// `distance_to_triangle(...).squared` of a quad's triangles from lane `g` on: for kPointsAtOnce
/// points, whose coordinates stand four times each.
HWY_INLINE DV squared_to_triangles(const DV3& p, const TriangleQuad& quad, std::size_t g) {
  const Doubles d;
  const Singles df;
  const auto corner = [&](int k) HWY_ATTR {
    const auto load = [&](int axis) HWY_ATTR {
      const float* const from = quad.vertex[k][axis] + g;
      if constexpr (hn::MaxLanes(Singles()) >= kQuadTriangles)
        return hn::PromoteTo(d, hn::LoadDup128(df, from));
      else
        return hn::PromoteTo(d, hn::Load(df, from));
    };
    return DV3{load(0), load(1), load(2)};
  };
  const DV3 a = corner(0), b = corner(1), c = corner(2);
  const DV3 to_a = minus(p, a), to_b = minus(p, b), to_c = minus(p, c);
  const DV3 h = minus(b, a), k = minus(c, a), m = minus(c, b);
  const DV edges = hn::Min(hn::Min(squared_to_edge(to_a, to_b, h), squared_to_edge(to_b, to_c, m)),
                           squared_to_edge(to_a, to_c, k));

  const DV3 n = cross(h, k);
  const DV nn = dot(n, n), zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const DV per = hn::Div(one, or_one(nn));
  const DV3 of_u = times(cross(k, n), per), of_v = times(cross(n, h), per);
  DV u = dot(to_a, of_u), v = dot(to_a, of_v);
  const auto rest = [&]() HWY_ATTR {
    const auto at = [&](DV to, DV along_h, DV along_k) HWY_ATTR {
      return hn::Sub(hn::Sub(to, hn::Mul(u, along_h)), hn::Mul(v, along_k));
    };
    return DV3{at(to_a.x, h.x, k.x), at(to_a.y, h.y, k.y), at(to_a.z, h.z, k.z)};
  };
  DV3 r = rest();
  u = hn::Add(u, dot(r, of_u));
  v = hn::Add(v, dot(r, of_v));
  const auto inside = hn::And(hn::And(hn::Gt(u, zero), hn::Gt(v, zero)),
                              hn::And(hn::Lt(hn::Add(u, v), one), hn::Gt(nn, zero)));
  if (hn::AllFalse(d, inside)) return edges;
  r = rest();
  const auto within = [](DV x, DV at_a, DV at_b, DV at_c) HWY_ATTR {
    return clamped(x, hn::Min(hn::Min(at_a, at_b), at_c), hn::Max(hn::Max(at_a, at_b), at_c));
  };
  r = {within(r.x, to_a.x, to_b.x, to_c.x), within(r.y, to_a.y, to_b.y, to_c.y),
       within(r.z, to_a.z, to_b.z, to_c.z)};
  return hn::IfThenElse(inside, hn::Min(dot(r, r), edges), edges);
}

/// From the points at columns x, from `g` on, to the box with `low(axis)` and `high(axis)`.
template <class Low, class High>
HWY_INLINE DV distances_to_box(const double (&x)[3][kBundlePoints], std::size_t g, const Low& low,
                               const High& high) {
  const Doubles d;
  DV sum = hn::Zero(d);
  for (int axis = 0; axis < 3; ++axis) {
    const DV at = hn::Load(d, x[axis] + g);
    const DV gap = hn::Max(hn::Max(hn::Sub(hn::Set(d, double{low(axis)}), at),
                                   hn::Sub(at, hn::Set(d, double{high(axis)}))),
                           hn::Zero(d));
    sum = hn::Add(sum, hn::Mul(gap, gap));
  }
  return hn::Sqrt(sum);
}

/// A bundle's points between floats, and the squared distance beyond which boxes are too far for
/// them. Lanes without a point reach nothing.
struct BoxLanes {
  alignas(64) float down[3][kBundlePoints];
  alignas(64) float up[3][kBundlePoints];
  alignas(64) float reach[kBundlePoints];

  void set(std::uint32_t lane, int axis, double x) {
    up[axis][lane] = rounded_up(x);
    down[axis][lane] = -rounded_up(-x);
  }
};
/// In the world: also what `up` lacks, and the squared distance beyond which triangles are too far.
struct BundleLanes : BoxLanes {
  alignas(64) float rest[3][kBundlePoints];
  alignas(64) float far[kBundlePoints];
};

/// Squared distances to a child's box for the points from `g` on, to within 2^-21 and 2^-147.
HWY_INLINE LV box_distances(const BoxLanes& p, const BvhNode& node, std::uint32_t child,
                            std::size_t g) {
  using hn::Max, hn::Mul, hn::Sub;
  const Lanes d;
  const auto along = [&](int axis) HWY_ATTR {
    const LV low = hn::Set(d, node.bound[axis][child]);
    const LV high = hn::Set(d, node.bound[3 + axis][child]);
    return Max(Max(Sub(low, hn::Load(d, p.up[axis] + g)), Sub(hn::Load(d, p.down[axis] + g), high)),
               hn::Zero(d));
  };
  const LV x = along(0), y = along(1), z = along(2);
  return hn::Add(hn::Add(Mul(x, x), Mul(y, y)), Mul(z, z));
}

/// Bits of the points from `g` on for which a quad's triangle is not surely farther than `far`.
///
/// Seen along any direction w a triangle is no nearer than the nearest of its corners: the distance
/// is at least min w . (p - corner) / |w|. From the triangle's middle to the point this is tight.
/// A point is a float and the rest of it, so the floats are off by 2^-19 of the distance, and by
/// 2^-46 of the largest coordinate, which `far` has in addition (NearestOfPoint).
HWY_INLINE std::uint32_t maybe_near(const BundleLanes& p, const TriangleQuad& quad,
                                    std::uint32_t lane, std::size_t g) {
  using hn::Add, hn::And, hn::Gt, hn::Min, hn::Mul, hn::Sub;
  const Lanes d;
  LV to[3][3], way[3];
  for (int axis = 0; axis < 3; ++axis) {
    const LV at = hn::Load(d, p.up[axis] + g), rest = hn::Load(d, p.rest[axis] + g);
    for (int k = 0; k < 3; ++k)
      to[k][axis] = Add(Sub(at, hn::Set(d, quad.vertex[k][axis][lane])), rest);
    way[axis] = Add(Add(to[0][axis], to[1][axis]), to[2][axis]);
  }
  const auto along = [&](const LV* v) HWY_ATTR {
    return Add(Add(Mul(way[0], v[0]), Mul(way[1], v[1])), Mul(way[2], v[2]));
  };
  const LV least = Min(Min(along(to[0]), along(to[1])), along(to[2]));
  const LV limit = Mul(along(way), hn::Load(d, p.far + g));
  // Products below lose their last bits.
  return bits_of(d, hn::Not(And(And(Gt(least, hn::Zero(d)), Gt(Mul(least, least), limit)),
                                Gt(limit, hn::Set(d, 1e-30f)))));
}
