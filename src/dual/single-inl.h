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

/// The scalar test.
HWY_NOINLINE bool settle_for_ray(const SingleRay& r, float t_limit, const TriangleQuad& q, int k,
                                 TriangleHit* hit) {
  const auto corner = [&](int i) {
    return Vec3{q.vertex[i][0][k], q.vertex[i][1][k], q.vertex[i][2][k]};
  };
  return intersect_triangle(r.setup(t_limit), corner(0), corner(1), corner(2), hit);
}

/// The number of the triangle at a place: four a quad.
inline std::uint32_t id_at(const ObjectTree& tree, std::uint32_t place) {
  return tree.quads[place / 4].id[place % 4];
}

/// A leaf's triangles with a ray: calls `take(place, hit)` for each hit.
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
        take(4 * quad + static_cast<std::uint32_t>(k),
             TriangleHit{t[k], v[k] / det[k], w[k] / det[k], det[k] > 0});
      }
      for (; unsettled != 0; unsettled &= unsettled - 1) {
        const int k = __builtin_ctz(unsettled);
        TriangleHit exact;
        if (settle_for_ray(r, t_limit, q, k, &exact))
          take(4 * quad + static_cast<std::uint32_t>(k), exact);
      }
    }
  }
}

/// A ray on its way through a subtree.
struct SingleWalk {
  SingleRay ray;
  std::uint32_t number;         ///< the caller's name for it
  const volatile float* s_far;  ///< where it ends, which hits bring nearer
  Waiting next;
  std::size_t top = 0;
  std::vector<Waiting> stack = std::vector<Waiting>(64);

  /// From node `root` down.
  void start(std::uint32_t root) {
    next = Waiting(0, 0, root, 0);
    top = 0;
  }
};

HWY_INLINE void prefetch_subtree(const ObjectTree& tree, std::uint32_t first, std::uint32_t count) {
  const char* at = count != 0 ? reinterpret_cast<const char*>(tree.quads.data() + first)
                              : reinterpret_cast<const char*>(tree.nodes.data() + first);
  for (int line = 0; line < 4; ++line) hwy::Prefetch(at + 64 * line);
}

/// Tests the boxes of the node that is next and puts those that are met on the stack, the nearest
/// on top. Returns the boxes tested.
HWY_INLINE std::uint32_t open_for_ray(const ObjectTree& tree, SingleWalk* walk) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  const Boxes d;
  const SingleRay& r = walk->ray;
  const BvhNode& node = tree.nodes[walk->next.first()];
  alignas(64) float nears[kBvhWidth];
  std::uint32_t met = 0;
  for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
    const auto at = [&](int row, float from, float per) __attribute__((always_inline)) {
      return Mul(Sub(hn::Load(d, node.bound[row] + g), hn::Set(d, from)), hn::Set(d, per));
    };
    const float per_z = r.mirrored ? -1.0f : 1.0f;
    const BV near = Max(Max(at(r.near_x, r.x_near, r.per_x), at(r.near_y, r.y_near, r.per_y)),
                        Max(at(r.near_z, r.z_near, per_z), hn::Set(d, r.s_near)));
    const BV far = Min(Min(at(r.far_x, r.x_far, r.per_x), at(r.far_y, r.y_far, r.per_y)),
                       Min(at(r.far_z, r.z_far, per_z), hn::Set(d, *walk->s_far)));
    hn::Store(near, d, nears + g);
    met |= bits_of(d, hn::Le(near, far)) << g;
  }
  if (HWY_UNLIKELY(walk->top + kBvhWidth > walk->stack.size()))
    walk->stack.resize(2 * walk->stack.size());
  Waiting* const bottom = walk->stack.data() + walk->top;
  Waiting* end = bottom;
  for (; met != 0; met &= met - 1) {
    const int c = __builtin_ctz(met);
    const Waiting child(nears[c], 0, node.first[c], node.count[c]);
    Waiting* place = end++;
    for (; place > bottom && place[-1].near() < child.near(); --place) place[-1].copy_to(place);
    child.copy_to(place);
  }
  walk->top = static_cast<std::size_t>(end - walk->stack.data());
  return node.children;
}

/// Rays through their subtrees, near boxes first, taking turns: while one waits for memory the
/// others go on, those at nodes first, those at leaves then, so that the branch between them is
/// foretold. `start(walk)` gives a walk its next ray, or says that there is none;
/// `leaf(walk, first quad, triangles)` tests a leaf's. Returns the boxes tested.
template <class Start, class Leaf>
HWY_NOINLINE std::uint64_t walk_singles(const ObjectTree& tree, SingleWalk* walks,
                                        std::uint32_t count, const Start& start, const Leaf& leaf) {
  std::uint64_t tests = 0;
  std::uint32_t at_nodes = 0, at_leaves = 0;
  const auto go_on = [&](int i) __attribute__((always_inline)) {
    SingleWalk& walk = walks[i];
    do {
      if (walk.top == 0) {
        if (start(&walk)) at_nodes |= 1u << i;
        return;
      }
      walk.stack[--walk.top].copy_to(&walk.next);
    } while (walk.next.near() > *walk.s_far);
    prefetch_subtree(tree, walk.next.first(), walk.next.count());
    const std::uint32_t is_leaf = walk.next.count() != 0 ? 1 : 0;
    at_leaves |= is_leaf << i;
    at_nodes |= (is_leaf ^ 1) << i;
  };
  for (std::uint32_t i = 0; i < count && start(&walks[i]); ++i) at_nodes |= 1u << i;
  while ((at_nodes | at_leaves) != 0) {
    for (std::uint32_t turn = std::exchange(at_nodes, 0); turn != 0; turn &= turn - 1) {
      const int i = __builtin_ctz(turn);
      tests += open_for_ray(tree, &walks[i]);
      go_on(i);
    }
    for (std::uint32_t turn = std::exchange(at_leaves, 0); turn != 0; turn &= turn - 1) {
      const int i = __builtin_ctz(turn);
      leaf(walks[i], walks[i].next.first(), walks[i].next.count());
      go_on(i);
    }
  }
  return tests;
}
