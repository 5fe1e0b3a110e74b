// The ray-triangle test over the rays of a packet and over the triangles of a leaf: the operations
// of `intersect_triangle` in its order. Included by dual/trace_simd.cpp, inside its namespace.

inline RaySetup setup_of(const RayPacket& p, std::uint32_t lane) {
  RaySetup r;
  float o[3];
  o[p.axis_x] = p.ox[lane];
  o[p.axis_y] = p.oy[lane];
  o[p.axis_z] = p.oz[lane];
  r.origin = {o[0], o[1], o[2]};
  r.shear_x = p.shear_x[lane];
  r.shear_y = p.shear_y[lane];
  r.shear_z = p.shear_z[lane];
  r.t_min = p.t_min[lane];
  r.t_max = p.t_limit[lane];
  r.axis_x = p.axis_x;
  r.axis_y = p.axis_y;
  r.axis_z = p.axis_z;
  return r;
}

template <class D>
struct Corner {
  hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Corner<D> sheared(D /*d*/, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z, hn::Vec<D> shear_x,
                             hn::Vec<D> shear_y) {
  return {hn::Sub(x, hn::Mul(shear_x, z)), hn::Sub(y, hn::Mul(shear_y, z)), z};
}

template <class V>
HWY_INLINE V edge_of(V px, V py, V qx, V qy) {
  return hn::Sub(hn::Mul(px, qy), hn::Mul(py, qx));
}
template <class V>
HWY_INLINE V spread_of(V px, V py, V qx, V qy) {
  return hn::Add(hn::Abs(hn::Mul(px, qy)), hn::Abs(hn::Mul(py, qx)));
}

/// Lanes that are hits, lanes that only the scalar test can settle, and the hits' values.
template <class D>
struct Tested {
  hn::Mask<D> hit, unsettled;
  hn::Vec<D> t, v, w, det;
};

/// What the edge functions of lanes say.
template <class D>
struct Edges {
  hn::Vec<D> u, v, w;
  hn::Mask<D> agree;  ///< in sign, or one is not a number and the scalar test settles it
};
template <class D>
HWY_INLINE Edges<D> edges_of(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c) {
  using hn::Max, hn::Min;
  const auto u = edge_of(c.x, c.y, b.x, b.y);
  const auto v = edge_of(a.x, a.y, c.x, c.y);
  const auto w = edge_of(b.x, b.y, a.x, a.y);
  const auto zero = hn::Zero(d);
  return {u, v, w,
          hn::Not(hn::And(hn::Lt(Min(Min(u, v), w), zero), hn::Gt(Max(Max(u, v), w), zero)))};
}

template <class D>
HWY_INLINE void finish_lanes(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c,
                             const Edges<D>& edges, hn::Vec<D> shear_z, hn::Vec<D> t_min,
                             hn::Vec<D> t_limit, Tested<D>* out) {
  using hn::Abs, hn::Add, hn::And, hn::AndNot, hn::Ge, hn::Le, hn::Mul;
  using V = hn::Vec<D>;
  const V u = edges.u, v = edges.v, w = edges.w, zero = hn::Zero(d);
  const V det = Add(Add(u, v), w);
  const V size = Abs(det);
  const auto nonzero = And(And(hn::Ne(u, zero), hn::Ne(v, zero)), hn::Ne(w, zero));
  const auto normal =
      And(Ge(size, hn::Set(d, kSmallDeterminant)), Le(size, hn::Set(d, kLargeDeterminant)));
  const V products = Add(Add(spread_of(c.x, c.y, b.x, b.y), spread_of(a.x, a.y, c.x, c.y)),
                         spread_of(b.x, b.y, a.x, a.y));
  const auto well_seen = Le(products, Mul(hn::Set(d, kLargestSpread), size));
  const V distance =
      Add(Add(Mul(u, Mul(shear_z, a.z)), Mul(v, Mul(shear_z, b.z))), Mul(w, Mul(shear_z, c.z)));
  const V reach = Abs(distance);
  const auto in_range =
      And(Ge(reach, hn::Set(d, kSmallDistance)), Le(reach, hn::Set(d, kLargeDeterminant)));
  const auto settled = And(And(nonzero, normal), And(well_seen, in_range));
  out->t = hn::Div(distance, det);
  const auto inside = And(Ge(out->t, t_min), Le(out->t, t_limit));
  out->hit = And(And(edges.agree, settled), inside);
  out->unsettled = AndNot(settled, edges.agree);
  out->v = v;
  out->w = w;
  out->det = det;
}

/// False where no lane can be a hit; `out` is then not written.
template <class D>
HWY_INLINE bool test_lanes(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c,
                           hn::Vec<D> shear_z, hn::Vec<D> t_min, hn::Vec<D> t_limit,
                           Tested<D>* out) {
  const Edges<D> edges = edges_of(d, a, b, c);
  if (HWY_LIKELY(hn::AllFalse(d, edges.agree))) return false;
  finish_lanes(d, a, b, c, edges, shear_z, t_min, t_limit, out);
  return true;
}

/// 1 where the edge functions of any ray agree in sign, else 0: without a branch, so that a leaf's
/// triangles are tested side by side.
HWY_INLINE std::uint32_t agrees_in_packet(const RayPacket& p, const TriangleQuad& q,
                                          std::uint32_t k) {
  using hn::Max, hn::Min;
  const Rays d;
  std::uint32_t some = 0;
  const float* ax = &q.vertex[0][p.axis_x][k];
  const float* ay = &q.vertex[0][p.axis_y][k];
  const float* az = &q.vertex[0][p.axis_z][k];
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    const RV ox = load(p.ox + g), oy = load(p.oy + g), oz = load(p.oz + g);
    const RV sx = load(p.shear_x + g), sy = load(p.shear_y + g);
    const auto moved = [&](int i) {
      return sheared(d, hn::Sub(set(ax[12 * i]), ox), hn::Sub(set(ay[12 * i]), oy),
                     hn::Sub(set(az[12 * i]), oz), sx, sy);
    };
    const Corner<Rays> a = moved(0), b = moved(1), c = moved(2);
    const RV u = edge_of(c.x, c.y, b.x, b.y), v = edge_of(a.x, a.y, c.x, c.y);
    const RV w = edge_of(b.x, b.y, a.x, a.y), zero = hn::Zero(d);
    const RM apart = hn::And(hn::Lt(Min(Min(u, v), w), zero), hn::Gt(Max(Max(u, v), w), zero));
    some |= hn::AllTrue(d, apart) ? 0u : 1u;
  }
  return some;
}

/// Calls `take(first lane, tested)` for the groups of lanes in which there may be a hit.
template <class Take>
HWY_INLINE void triangle_in_packet(const RayPacket& p, const TriangleQuad& q, std::uint32_t k,
                                   const Take& take) {
  const Rays d;
  const float(*corner)[3][4] = &q.vertex[0];
  for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
    const RV ox = load(p.ox + g), oy = load(p.oy + g), oz = load(p.oz + g);
    const RV sx = load(p.shear_x + g), sy = load(p.shear_y + g);
    const auto moved = [&](int i) {
      return sheared(d, hn::Sub(set(corner[i][p.axis_x][k]), ox),
                     hn::Sub(set(corner[i][p.axis_y][k]), oy),
                     hn::Sub(set(corner[i][p.axis_z][k]), oz), sx, sy);
    };
    Tested<Rays> tested;
    if (test_lanes(d, moved(0), moved(1), moved(2), load(p.shear_z + g), load(p.t_min + g),
                   load(p.t_limit + g), &tested))
      take(g, tested);
  }
}
