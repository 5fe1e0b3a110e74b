// Boxes and triangles against one point, in lanes. Included once a SIMD target by
// nearest/nearest_simd.cpp, inside its namespace.

using Boxes = hn::CappedTag<float, kBvhWidth>;
using BV = hn::Vec<Boxes>;
using Doubles = hn::CappedTag<double, kQuadTriangles>;
using Singles = hn::Rebind<float, Doubles>;
using DV = hn::Vec<Doubles>;

template <class D, class M>
HWY_INLINE std::uint32_t bits_of(D d, M mask) {
  std::uint8_t byte[8] = {};
  hn::StoreMaskBits(d, mask, byte);
  return std::uint32_t{byte[0]} & ((1u << hn::Lanes(d)) - 1);
}

/// The point between floats.
struct FloatPoint {
  Vec3 down, up;

  explicit FloatPoint(Point p)
      : down{-rounded_up(-p.x), -rounded_up(-p.y), -rounded_up(-p.z)},
        up{rounded_up(p.x), rounded_up(p.y), rounded_up(p.z)} {}
};

/// Squared distances to the boxes of a node from lane `g` on, to within 2^-21 and 2^-147.
HWY_INLINE BV box_distances(const FloatPoint& p, const BvhNode& node, std::size_t g) {
  using hn::Max, hn::Mul, hn::Sub;
  const Boxes d;
  const auto along = [&](int axis, float down, float up) HWY_ATTR {
    return Max(Max(Sub(hn::Load(d, node.bound[axis] + g), hn::Set(d, up)),
                   Sub(hn::Set(d, down), hn::Load(d, node.bound[3 + axis] + g))),
               hn::Zero(d));
  };
  const BV x = along(0, p.down.x, p.up.x), y = along(1, p.down.y, p.up.y);
  const BV z = along(2, p.down.z, p.up.z);
  return hn::Add(hn::Add(Mul(x, x), Mul(y, y)), Mul(z, z));
}

struct Lanes3 {
  DV x, y, z;
};

HWY_INLINE Lanes3 minus(const Lanes3& a, const Lanes3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE DV dot(const Lanes3& a, const Lanes3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Lanes3 times(DV s, const Lanes3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE DV clamped(DV x, DV low, DV high) {
  return hn::Min(hn::Max(x, low), high);
}
/// x where it is above 0, else 1: to divide by.
HWY_INLINE DV or_one(DV x) {
  const Doubles d;
  return hn::IfThenElse(hn::Gt(x, hn::Zero(d)), x, hn::Set(d, 1.0));
}

/// The square of `from_edge` (nearest/point_triangle_body.h), operation by operation.
HWY_INLINE DV squared_to_edge(const Lanes3& to_a, const Lanes3& to_b, const Lanes3& h) {
  const Doubles d;
  const Lanes3 w{hn::Add(to_a.x, to_b.x), hn::Add(to_a.y, to_b.y), hn::Add(to_a.z, to_b.z)};
  const DV t = hn::Div(dot(w, h), or_one(dot(h, h)));
  const auto at_b = hn::Ge(t, hn::Set(d, 1.0)), at_a = hn::Le(t, hn::Set(d, -1.0));
  const DV half = hn::Set(d, 0.5);
  const auto between = [&](DV sum, DV slope, DV a, DV b) HWY_ATTR {
    const DV r =
        clamped(hn::Mul(hn::Sub(sum, hn::Mul(t, slope)), half), hn::Min(a, b), hn::Max(a, b));
    return hn::IfThenElse(at_b, b, hn::IfThenElse(at_a, a, r));
  };
  const Lanes3 r{between(w.x, h.x, to_a.x, to_b.x), between(w.y, h.y, to_a.y, to_b.y),
                 between(w.z, h.z, to_a.z, to_b.z)};
  return dot(r, r);
}

/// `distance_to_triangle(...).squared` of a quad's triangles from lane `g` on.
HWY_INLINE DV squared_to_triangles(const Lanes3& p, const TriangleQuad& quad, std::size_t g) {
  const Doubles d;
  const Singles df;
  const auto corner = [&](int k) HWY_ATTR {
    const auto load = [&](int axis) HWY_ATTR {
      return hn::PromoteTo(d, hn::Load(df, quad.vertex[k][axis] + g));
    };
    return Lanes3{load(0), load(1), load(2)};
  };
  const Lanes3 a = corner(0), b = corner(1), c = corner(2);
  const Lanes3 to_a = minus(p, a), to_b = minus(p, b), to_c = minus(p, c);
  const Lanes3 h = minus(b, a), k = minus(c, a), m = minus(c, b);
  const DV edges = hn::Min(hn::Min(squared_to_edge(to_a, to_b, h), squared_to_edge(to_b, to_c, m)),
                           squared_to_edge(to_a, to_c, k));

  const Lanes3 n = cross(h, k);
  const DV nn = dot(n, n), zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const DV per = hn::Div(one, or_one(nn));
  const Lanes3 of_u = times(per, cross(k, n)), of_v = times(per, cross(n, h));
  DV u = dot(to_a, of_u), v = dot(to_a, of_v);
  const auto rest = [&]() HWY_ATTR {
    const auto at = [&](DV to, DV along_h, DV along_k) HWY_ATTR {
      return hn::Sub(hn::Sub(to, hn::Mul(u, along_h)), hn::Mul(v, along_k));
    };
    return Lanes3{at(to_a.x, h.x, k.x), at(to_a.y, h.y, k.y), at(to_a.z, h.z, k.z)};
  };
  Lanes3 r = rest();
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

/// Bits of the quad's triangles that are surely farther than `far`, whose square is given.
///
/// Seen along any direction g a triangle is no nearer than the nearest of its corners: the distance
/// is at least min g . (p - corner) / |g|. From the triangle's middle to the point this is tight.
/// The floats are off by 2^-19 of the distance and of the largest coordinate together, which `far`
/// has in addition (NearestOfPoint).
HWY_INLINE std::uint32_t surely_far(Vec3 p, const TriangleQuad& quad, float far_squared) {
  using hn::Add, hn::And, hn::Gt, hn::Min, hn::Mul, hn::Sub;
  const hn::CappedTag<float, kQuadTriangles> d;
  using V = hn::Vec<decltype(d)>;
  std::uint32_t far = 0;
  for (std::size_t g = 0; g < kQuadTriangles; g += hn::Lanes(d)) {
    V to[3][3], way[3];
    for (int axis = 0; axis < 3; ++axis) {
      const V at = hn::Set(d, axis == 0 ? p.x : axis == 1 ? p.y : p.z);
      for (int k = 0; k < 3; ++k) to[k][axis] = Sub(at, hn::Load(d, quad.vertex[k][axis] + g));
      way[axis] = Add(Add(to[0][axis], to[1][axis]), to[2][axis]);
    }
    const auto along = [&](const V* v) HWY_ATTR {
      return Add(Add(Mul(way[0], v[0]), Mul(way[1], v[1])), Mul(way[2], v[2]));
    };
    const V least = Min(Min(along(to[0]), along(to[1])), along(to[2]));
    const V limit = Mul(along(way), hn::Set(d, far_squared));
    // Products below lose their last bits.
    const auto is_far = And(And(Gt(least, hn::Zero(d)), Gt(Mul(least, least), limit)),
                            Gt(limit, hn::Set(d, 1e-30f)));
    far |= bits_of(d, is_far) << g;
  }
  return far;
}
