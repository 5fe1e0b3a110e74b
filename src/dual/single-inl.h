// One ray through a subtree, eight boxes at a time: where few rays are left to share it. Included
// once a SIMD target by dual/trace_simd.cpp, inside its namespace.

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

/// A ray as the kernel wants it; fields as in RayPacket.
struct SingleRay {
  float x_near, x_far, y_near, y_far, z_near, z_far;
  float per_x, per_y, s_near;
  int near_x, far_x, near_y, far_y, near_z, far_z;
  float ox, oy, oz, shear_x, shear_y, shear_z, t_min;
  int axis_x, axis_y, axis_z;
  bool mirrored;

  [[nodiscard]] RaySetup setup(float t_limit) const {
    float o[3];
    o[axis_x] = ox;
    o[axis_y] = oy;
    o[axis_z] = oz;
    return {{o[0], o[1], o[2]}, shear_x, shear_y, shear_z, t_min, t_limit, axis_x, axis_y, axis_z};
  }
};

/// A leaf's triangles with a ray: calls `take(id, hit)` for each hit.
template <class Take>
HWY_INLINE void leaf_with_ray(const ObjectTree& tree, const SingleRay& r, float t_limit,
                              std::uint32_t quad, std::uint32_t count, const Take& take) {
  using Quad = hn::CappedTag<float, 4>;
  const Quad d;
  for (std::uint32_t done = 0; done < count; done += 4, ++quad) {
    const TriangleQuad& q = tree.quads[quad];
    const std::uint32_t used = (1u << std::min(4u, count - done)) - 1;
    const float* x = q.vertex[0][r.axis_x];
    const float* y = q.vertex[0][r.axis_y];
    const float* z = q.vertex[0][r.axis_z];
    for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
      const auto from = [&](float o) { return hn::Set(d, o); };
      const auto moved = [&](int i) __attribute__((always_inline)) {
        return sheared(d, hn::Sub(hn::LoadU(d, x + 12 * i + g), from(r.ox)),
                       hn::Sub(hn::LoadU(d, y + 12 * i + g), from(r.oy)),
                       hn::Sub(hn::LoadU(d, z + 12 * i + g), from(r.oz)), from(r.shear_x),
                       from(r.shear_y));
      };
      Tested<Quad> tested;
      if (!test_lanes(d, moved(0), moved(1), moved(2), from(r.shear_z), from(r.t_min),
                      from(t_limit), &tested))
        continue;
      std::uint32_t hit = bits_of(d, tested.hit) << g & used;
      std::uint32_t unsettled = bits_of(d, tested.unsettled) << g & used;
      if ((hit | unsettled) == 0) continue;
      alignas(16) float t[4], v[4], w[4], det[4];
      hn::Store(tested.t, d, t + g);
      hn::Store(tested.v, d, v + g);
      hn::Store(tested.w, d, w + g);
      hn::Store(tested.det, d, det + g);
      for (; hit != 0; hit &= hit - 1) {
        const int k = __builtin_ctz(hit);
        take(q.id[k], TriangleHit{t[k], v[k] / det[k], w[k] / det[k], det[k] > 0});
      }
      for (; unsettled != 0; unsettled &= unsettled - 1) {
        const int k = __builtin_ctz(unsettled);
        const auto corner = [&](int i) {
          return Vec3{q.vertex[i][0][k], q.vertex[i][1][k], q.vertex[i][2][k]};
        };
        TriangleHit exact;
        if (intersect_triangle(r.setup(t_limit), corner(0), corner(1), corner(2), &exact))
          take(q.id[k], exact);
      }
    }
  }
}

/// From node `number` down, near boxes first. `leaf(first quad, triangles)` tests a leaf's;
/// `s_far` is where the ray ends, which hits bring nearer. Returns the boxes tested.
template <class Leaf>
HWY_NOINLINE std::uint64_t walk_single(const ObjectTree& tree, const SingleRay& r,
                                       std::uint32_t number, const volatile float& s_far,
                                       std::vector<Waiting>* stack, const Leaf& leaf) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  const Boxes d;
  const BV per_x = hn::Set(d, r.per_x), per_y = hn::Set(d, r.per_y);
  const BV per_z = hn::Set(d, r.mirrored ? -1.0f : 1.0f);
  const BV x0 = hn::Set(d, r.x_near), x1 = hn::Set(d, r.x_far);
  const BV y0 = hn::Set(d, r.y_near), y1 = hn::Set(d, r.y_far);
  const BV z0 = hn::Set(d, r.z_near), z1 = hn::Set(d, r.z_far);
  const BV s_near = hn::Set(d, r.s_near);
  std::size_t top = 0;
  std::uint64_t tests = 0;
  Waiting* waiting = stack->data();
  std::size_t room = stack->size() - kBvhWidth;
  float far_end = s_far;
  for (;;) {
    const BvhNode& node = tree.nodes[number];
    tests += node.children;
    alignas(64) float nears[kBvhWidth];
    std::uint32_t met = 0;
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
      const auto at = [&](int row, BV from, BV per) __attribute__((always_inline)) {
        return Mul(Sub(hn::Load(d, node.bound[row] + g), from), per);
      };
      const BV near = Max(Max(at(r.near_x, x0, per_x), at(r.near_y, y0, per_y)),
                          Max(at(r.near_z, z0, per_z), s_near));
      const BV far = Min(Min(at(r.far_x, x1, per_x), at(r.far_y, y1, per_y)),
                         Min(at(r.far_z, z1, per_z), hn::Set(d, far_end)));
      hn::Store(near, d, nears + g);
      met |= bits_of(d, hn::Le(near, far)) << g;
    }
    Waiting next;
    bool found = met != 0;
    if (found) {
      int c = __builtin_ctz(met);
      met &= met - 1;
      Waiting(nears[c], 0, node.first[c], node.count[c]).copy_to(&next);
      if (HWY_UNLIKELY(top > room)) {
        stack->resize(2 * stack->size());
        waiting = stack->data();
        room = stack->size() - kBvhWidth;
      }
      const std::size_t bottom = top;
      for (; met != 0; met &= met - 1) {
        c = __builtin_ctz(met);
        Waiting other(nears[c], 0, node.first[c], node.count[c]);
        if (other.near() < next.near()) std::swap(other, next);
        std::size_t place = top++;
        for (; place > bottom && waiting[place - 1].near() < other.near(); --place)
          waiting[place - 1].copy_to(waiting + place);
        other.copy_to(waiting + place);
      }
    }
    for (;;) {
      if (found && next.count() == 0) break;
      if (found) {
        leaf(next.first(), next.count());
        far_end = s_far;
      }
      do {
        if (top == 0) return tests;
        waiting[--top].copy_to(&next);
      } while (next.near() > far_end);
      found = true;
    }
    number = next.first();
  }
}
