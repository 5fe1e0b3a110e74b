// Rays with a quad of triangles each, several rays at once. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

/// Rays at once: as many as a vector has blocks of four lanes, and on short vectors one, a part of
/// its quad at a time.
inline constexpr std::uint32_t kQuadRays = std::max<std::uint32_t>(1, hn::MaxLanes(Rays()) / 4);

/// kQuadRays rays and a quad each, its triangles from `g` on: lane 4 i + k is ray i and triangle
/// g + k.
HWY_INLINE void test_quads(const SharedAxes& a, const StreamRay* const* ray,
                           const TriangleQuad* const* quad, std::size_t g, Tested<Rays>* tested) {
  const Rays d;
  const float *x[kQuadRays], *y[kQuadRays], *z[kQuadRays];
  for (std::uint32_t i = 0; i < kQuadRays; ++i) {
    const auto& corner = quad[i]->vertex[0];
    x[i] = corner[a.axis_x] + g;
    y[i] = corner[a.axis_y] + g;
    z[i] = corner[a.axis_z] + g;
  }
#if HWY_TARGET == HWY_SCALAR
  const auto corners = [&](const float* const* axis, int i) { return hn::Set(d, axis[0][12 * i]); };
  const RV reach = set(quad[0]->reach[g]);
  const RV ox = set(ray[0]->ox), oy = set(ray[0]->oy), oz = set(ray[0]->oz);
  const RV shear_x = set(ray[0]->shear_x), shear_y = set(ray[0]->shear_y);
  const RV shear_z = set(ray[0]->shear_z), t_min = set(ray[0]->t_min);
  const RV t_limit = set(ray[0]->t_limit);
#else
  const auto corners = [&](const float* const* axis, int i) __attribute__((always_inline)) {
    return load_blocks([&](std::size_t k)
                           __attribute__((always_inline)) { return axis[k] + 12 * i; });
  };
  const RV reach =
      load_blocks([&](std::size_t i) __attribute__((always_inline)) { return quad[i]->reach + g; });
  const RV o =
      load_blocks([&](std::size_t i) __attribute__((always_inline)) { return &ray[i]->ox; });
  const RV s =
      load_blocks([&](std::size_t i) __attribute__((always_inline)) { return &ray[i]->shear_x; });
  const RV ox = hn::Broadcast<0>(o), oy = hn::Broadcast<1>(o), oz = hn::Broadcast<2>(o);
  const RV shear_x = hn::Broadcast<0>(s), shear_y = hn::Broadcast<1>(s);
  const RV shear_z = hn::Broadcast<2>(s), t_min = hn::Broadcast<3>(s);
  const RV t_limit = hn::Broadcast<3>(o);
#endif
  const auto moved = [&](int i) __attribute__((always_inline)) {
    return sheared(d, hn::Sub(corners(x, i), ox), hn::Sub(corners(y, i), oy),
                   hn::Sub(corners(z, i), oz), shear_x, shear_y);
  };
  const Corner<Rays> c0 = moved(0), c1 = moved(1), c2 = moved(2);
  finish_lanes(d, c0, c1, c2, edges_of(d, c0, c1, c2, reach), reach, shear_z, t_min, t_limit,
               tested);
}

/// Rays and a quad each. What they meet: bit 4 i + k of `hit` is ray i and triangle k, and those
/// that stage 2 must settle are in `unsettled`.
struct QuadHits {
  alignas(64) float low[4 * SingleWalks::kMost];
  alignas(64) float high[4 * SingleWalks::kMost];
  std::uint64_t hit, unsettled, front;

  HWY_INLINE void keep(const Tested<Rays>& tested, std::size_t place) {
    const Rays d;
    hit |= std::uint64_t{bits_of(d, tested.hit)} << place;
    unsettled |= std::uint64_t{bits_of(d, tested.unsettled)} << place;
    front |= std::uint64_t{bits_of(d, hn::Gt(tested.det, hn::Zero(d)))} << place;
    hn::Store(tested.low, d, low + place);
    hn::Store(tested.high, d, high + place);
  }
  [[nodiscard]] HWY_INLINE Interval at(std::uint32_t b) const { return {low[b], high[b]}; }
  [[nodiscard]] HWY_INLINE bool is_front(std::uint32_t b) const { return (front >> b & 1) != 0; }
};
static_assert(4 * SingleWalks::kMost <= 64);

/// `count` rays, kMost at most, without a branch: whether a ray meets any of its quad, nobody can
/// foretell. `ray_at(i)` and `quad_at(i)`: of those and of kQuadRays - 1 more.
template <class RayAt, class QuadAt>
HWY_INLINE void meet_quads(const SharedAxes& a, std::uint32_t count, const RayAt& ray_at,
                           const QuadAt& quad_at, QuadHits* hits) {
  hits->hit = hits->unsettled = hits->front = 0;
  for (std::uint32_t base = 0; base < count; base += kQuadRays) {
    const StreamRay* ray[kQuadRays];
    const TriangleQuad* quad[kQuadRays];
    for (std::uint32_t i = 0; i < kQuadRays; ++i) {
      ray[i] = ray_at(base + i);
      quad[i] = quad_at(base + i);
    }
    for (std::size_t g = 0; g < 4; g += ray_lanes()) {
      Tested<Rays> tested;
      test_quads(a, ray, quad, g, &tested);
      hits->keep(tested, 4 * base + g);
    }
  }
}
