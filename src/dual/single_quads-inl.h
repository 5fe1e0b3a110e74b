// Rays with a quad of triangles each, several rays at once. Included once a SIMD target by
// dual/trace_simd.cpp, inside its namespace.

/// Rays and a quad each. What they meet: bit 4 i + k of `hit` is ray i and triangle k, and those
/// that the scalar test must settle are in `unsettled`.
struct QuadHits {
  alignas(64) float t[4 * SingleWalks::kMost];
  alignas(64) float v[4 * SingleWalks::kMost];
  alignas(64) float w[4 * SingleWalks::kMost];
  alignas(64) float det[4 * SingleWalks::kMost];
  std::uint64_t hit, unsettled;
};
static_assert(4 * SingleWalks::kMost <= 64);

/// As many rays at once as a vector has blocks of four lanes, and without a branch: whether a ray
/// meets any of its quad, nobody can foretell. `at`: `count` walks, and room for 3 more.
HWY_INLINE void meet_quads(const ObjectTree& tree, const SharedAxes& a, const SingleWalks& walks,
                           std::uint32_t* at, std::uint32_t count, QuadHits* hits) {
  const Rays d;
  const std::size_t lanes = std::min<std::size_t>(4, hn::Lanes(d));
  const std::uint32_t rays = static_cast<std::uint32_t>(hn::Lanes(d) / lanes);
  for (std::uint32_t i = 1; i < rays; ++i) at[count + i - 1] = at[count - 1];
  hits->hit = hits->unsettled = 0;
  for (std::uint32_t base = 0; base < count; base += rays) {
    const float *x[4], *y[4], *z[4];
    const StreamRay* ray[4];
    for (std::uint32_t i = 0; i < rays; ++i) {
      const auto& corner = tree.quads[walks.first[at[base + i]]].vertex[0];
      x[i] = corner[a.axis_x];
      y[i] = corner[a.axis_y];
      z[i] = corner[a.axis_z];
      ray[i] = walks.ray[at[base + i]];
    }
    for (std::size_t g = 0; g < 4; g += lanes) {
#if HWY_TARGET == HWY_SCALAR
      const auto corners = [&](const float* const* axis, int i) {
        return hn::Set(d, axis[0][12 * i + static_cast<int>(g)]);
      };
      const RV ox = set(ray[0]->ox), oy = set(ray[0]->oy), oz = set(ray[0]->oz);
      const RV shear_x = set(ray[0]->shear_x), shear_y = set(ray[0]->shear_y);
      const RV shear_z = set(ray[0]->shear_z), t_min = set(ray[0]->t_min);
      const RV t_limit = set(ray[0]->t_limit);
#else
      const auto corners = [&](const float* const* axis, int i) __attribute__((always_inline)) {
        return load_blocks([&](std::size_t k)
                               __attribute__((always_inline)) { return axis[k] + 12 * i; });
      };
      const RV o =
          load_blocks([&](std::size_t i) __attribute__((always_inline)) { return &ray[i]->ox; });
      const RV s = load_blocks([&](std::size_t i)
                                   __attribute__((always_inline)) { return &ray[i]->shear_x; });
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
      Tested<Rays> tested;
      finish_lanes(d, c0, c1, c2, edges_of(d, c0, c1, c2), shear_z, t_min, t_limit, &tested);
      const std::size_t place = 4 * base + g;
      hits->hit |= std::uint64_t{bits_of(d, tested.hit)} << place;
      hits->unsettled |= std::uint64_t{bits_of(d, tested.unsettled)} << place;
      hn::Store(tested.t, d, hits->t + place);
      hn::Store(tested.v, d, hits->v + place);
      hn::Store(tested.w, d, hits->w + place);
      hn::Store(tested.det, d, hits->det + place);
    }
  }
}
