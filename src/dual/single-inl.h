// One ray through a subtree, eight boxes at a time: where few rays are left to share it. Included
// once a SIMD target by dual/trace_simd.cpp, inside its namespace.

/// What the rays of a packet or of a stream share.
struct SharedAxes {
  int axis_x, axis_y, axis_z;
  int near_x, far_x, near_y, far_y, near_z, far_z;
  float pad_x, pad_y, pad_z;  ///< added to an origin for near planes, taken from it for far ones
  float per_z;

  /// `Bundle`: RayPacket or Stream.
  template <class Bundle>
  explicit SharedAxes(const Bundle& b)
      : axis_x(b.axis_x),
        axis_y(b.axis_y),
        axis_z(b.axis_z),
        near_x(b.near_x),
        far_x(b.far_x),
        near_y(b.near_y),
        far_y(b.far_y),
        near_z(b.near_z),
        far_z(b.far_z),
        // A lower plane moves down by the pad as the origin moves up, an upper plane up.
        pad_x(b.near_x < 3 ? b.pad : -b.pad),
        pad_y(b.near_y < 3 ? b.pad : -b.pad),
        pad_z(b.near_z < 3 ? b.pad : -b.pad),
        per_z(b.mirrored ? -1.0f : 1.0f) {}
};

/// The scalar test.
HWY_NOINLINE bool settle_for_ray(const SharedAxes& a, const StreamRay& r, const StreamShear& s,
                                 const TriangleQuad& q, int k, TriangleHit* hit) {
  float o[3];
  o[a.axis_x] = r.ox;
  o[a.axis_y] = r.oy;
  o[a.axis_z] = r.oz;
  const RaySetup setup{{o[0], o[1], o[2]}, s.shear_x, s.shear_y, s.shear_z, s.t_min,
                       s.t_limit,          a.axis_x,  a.axis_y,  a.axis_z};
  const auto corner = [&](int i) {
    return Vec3{q.vertex[i][0][k], q.vertex[i][1][k], q.vertex[i][2][k]};
  };
  return intersect_triangle(setup, corner(0), corner(1), corner(2), hit);
}

/// The number of the triangle at a place: four a quad.
inline std::uint32_t id_at(const ObjectTree& tree, std::uint32_t place) {
  return tree.quads[place / 4].id[place % 4];
}

/// A leaf's triangles with a ray: calls `take(place, hit)` for each hit.
template <class Take>
HWY_INLINE void leaf_with_ray(const ObjectTree& tree, const SharedAxes& a, const StreamRay& r,
                              const StreamShear& s, std::uint32_t quad, std::uint32_t count,
                              const Take& take) {
  using Quad = hn::CappedTag<float, 4>;
  const Quad d;
  for (std::uint32_t done = 0; done < count; done += 4, ++quad) {
    const TriangleQuad& q = tree.quads[quad];
    const std::uint32_t used = (1u << std::min(4u, count - done)) - 1;
    const float* x = q.vertex[0][a.axis_x];
    const float* y = q.vertex[0][a.axis_y];
    const float* z = q.vertex[0][a.axis_z];
    for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
      const auto from = [&](float o) { return hn::Set(d, o); };
      const auto moved = [&](int i) __attribute__((always_inline)) {
        return sheared(d, hn::Sub(hn::LoadU(d, x + 12 * i + g), from(r.ox)),
                       hn::Sub(hn::LoadU(d, y + 12 * i + g), from(r.oy)),
                       hn::Sub(hn::LoadU(d, z + 12 * i + g), from(r.oz)), from(s.shear_x),
                       from(s.shear_y));
      };
      Tested<Quad> tested;
      if (!test_lanes(d, moved(0), moved(1), moved(2), from(s.shear_z), from(s.t_min),
                      from(s.t_limit), &tested))
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
        if (settle_for_ray(a, r, s, q, k, &exact))
          take(4 * quad + static_cast<std::uint32_t>(k), exact);
      }
    }
  }
}

/// A ray on its way through a subtree, and what waits for it: the nearest last.
struct SingleWalk {
  const StreamRay* ray;
  const StreamShear* shear;
  std::uint32_t number;        ///< the caller's name for it
  std::uint32_t first, count;  ///< what is next, as in BvhNode
  std::size_t top = 0;
  std::vector<float> nears = std::vector<float>(64);  ///< where the ray enters the box
  std::vector<std::uint32_t> firsts = std::vector<std::uint32_t>(64);
  std::vector<std::uint32_t> counts = std::vector<std::uint32_t>(64);

  void start(std::uint32_t begin, std::uint32_t triangles) {
    first = begin;
    count = triangles;
    top = 0;
  }
  void grow() {
    nears.resize(2 * nears.size());
    firsts.resize(nears.size());
    counts.resize(nears.size());
  }
};

HWY_INLINE void prefetch_subtree(const ObjectTree& tree, std::uint32_t first, std::uint32_t count) {
  const char* at = count != 0 ? reinterpret_cast<const char*>(tree.quads.data() + first)
                              : reinterpret_cast<const char*>(tree.nodes.data() + first);
  for (int line = 0; line < 4; ++line) hwy::Prefetch(at + 64 * line);
}

using Numbers = hn::RebindToUnsigned<Boxes>;

#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
/// Eight numbers, the largest first, by a bitonic network: which of a node's boxes a ray meets, and
/// in which order, no branch can foretell.
HWY_INLINE hn::Vec<Numbers> sorted_down(hn::Vec<Numbers> v) {
  const Numbers d;
  const hn::Repartition<std::uint64_t, Numbers> d64;
  const auto by_ones = [&] {
    const auto other = hn::Reverse2(d, v);
    v = hn::OddEven(hn::Min(v, other), hn::Max(v, other));
  };
  const auto by_twos = [&](hn::Vec<Numbers> other) {
    v = hn::BitCast(
        d, hn::OddEven(hn::BitCast(d64, hn::Min(v, other)), hn::BitCast(d64, hn::Max(v, other))));
  };
  by_ones();
  by_twos(hn::Reverse4(d, v));
  by_ones();
  const auto other = hn::Reverse8(d, v);
  v = hn::OddEvenBlocks(hn::Min(v, other), hn::Max(v, other));
  by_twos(hn::Shuffle1032(v));
  by_ones();
  return v;
}
#endif

/// Tests the boxes of the node that is next and puts those that are met on the stack, the nearest
/// on top, to within a part in 2^19. Returns the boxes tested.
HWY_INLINE std::uint32_t open_for_ray(const ObjectTree& tree, const SharedAxes& a,
                                      SingleWalk* walk) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  // A key: where the box is entered, and its number in the bits below. Of boxes not met: 0.
  constexpr std::uint32_t kNearBits = 0x7ffffff0, kMet = 8, kChild = 7;
  const Boxes d;
  const Numbers du;
  const StreamRay& r = *walk->ray;
  const BvhNode& node = tree.nodes[walk->first];
  alignas(32) static constexpr std::uint32_t kNumbers[kBvhWidth] = {8, 9, 10, 11, 12, 13, 14, 15};
  if (HWY_UNLIKELY(walk->top + kBvhWidth > walk->nears.size())) walk->grow();
  float* const nears = walk->nears.data() + walk->top;
  std::uint32_t* const firsts = walk->firsts.data() + walk->top;
  std::uint32_t* const counts = walk->counts.data() + walk->top;
  const auto clip = [&](std::size_t g, BV * near, BV * far) __attribute__((always_inline)) {
    const auto at = [&](int row, float from, float per) __attribute__((always_inline)) {
      return Mul(Sub(hn::Load(d, node.bound[row] + g), hn::Set(d, from)), hn::Set(d, per));
    };
    *near = Max(Max(at(a.near_x, r.ox + a.pad_x, r.per_x), at(a.near_y, r.oy + a.pad_y, r.per_y)),
                Max(at(a.near_z, r.oz + a.pad_z, a.per_z), hn::Set(d, r.s_near)));
    *far = Min(Min(at(a.far_x, r.ox - a.pad_x, r.per_x), at(a.far_y, r.oy - a.pad_y, r.per_y)),
               Min(at(a.far_z, r.oz - a.pad_z, a.per_z), hn::Set(d, r.s_far)));
  };
  BV near, far;
#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
  clip(0, &near, &far);
  const auto met = hn::Le(near, far);
  const auto bits = hn::And(hn::BitCast(du, near), hn::Set(du, kNearBits));
  const auto keys = sorted_down(
      hn::IfThenElseZero(hn::RebindMask(du, met), hn::Or(bits, hn::Load(du, kNumbers))));
  const auto children = hn::And(keys, hn::Set(du, kChild));
  const auto order = hn::IndicesFromVec(du, children);
  const hn::Rebind<std::uint8_t, Numbers> d8;
  hn::StoreU(hn::TableLookupLanes(near, hn::IndicesFromVec(d, children)), d, nears);
  hn::StoreU(hn::TableLookupLanes(hn::Load(du, node.first), order), du, firsts);
  hn::StoreU(hn::TableLookupLanes(hn::PromoteTo(du, hn::LoadU(d8, node.count)), order), du, counts);
  walk->top += hn::CountTrue(d, met);
#else
  alignas(32) float entered[kBvhWidth];
  std::uint32_t keys[kBvhWidth], end = 0;
  for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
    clip(g, &near, &far);
    hn::Store(near, d, entered + g);
    for (std::uint32_t met = bits_of(d, hn::Le(near, far)); met != 0; met &= met - 1) {
      const auto c = g + static_cast<std::uint32_t>(__builtin_ctz(met));
      const std::uint32_t key =
          (std::bit_cast<std::uint32_t>(entered[c]) & kNearBits) | kNumbers[c];
      std::uint32_t place = end++;
      for (; place > 0 && keys[place - 1] < key; --place) keys[place] = keys[place - 1];
      keys[place] = key;
    }
  }
  static_cast<void>(du);
  for (std::uint32_t i = 0; i < end; ++i) {
    const std::uint32_t c = keys[i] & kChild;
    nears[i] = entered[c];
    firsts[i] = node.first[c];
    counts[i] = node.count[c];
  }
  walk->top += end;
#endif
  static_assert(kMet == kBvhWidth);
  return node.children;
}

/// Rays through their subtrees, near boxes first, taking turns: while one waits for memory the
/// others go on, those at nodes first, those at leaves then, so that the branch between them is
/// foretold. `start(walk)` gives a walk its next ray, or says that there is none;
/// `leaf(walk, first quad, triangles)` tests a leaf's. Returns the boxes tested.
template <class Start, class Leaf>
HWY_NOINLINE std::uint64_t walk_singles(const ObjectTree& tree, const SharedAxes& axes,
                                        SingleWalk* walks, std::uint32_t count, const Start& start,
                                        const Leaf& leaf) {
  std::uint64_t tests = 0;
  std::uint32_t at_nodes = 0, at_leaves = 0;
  const auto wait = [&](std::uint32_t i) __attribute__((always_inline)) {
    const SingleWalk& walk = walks[i];
    prefetch_subtree(tree, walk.first, walk.count);
    const std::uint32_t is_leaf = walk.count != 0 ? 1 : 0;
    at_leaves |= is_leaf << i;
    at_nodes |= (is_leaf ^ 1) << i;
  };
  const auto go_on = [&](std::uint32_t i) __attribute__((always_inline)) {
    SingleWalk& walk = walks[i];
    do {
      if (walk.top == 0) {
        if (start(&walk)) wait(i);
        return;
      }
      --walk.top;
    } while (walk.nears[walk.top] > walk.ray->s_far);
    walk.first = walk.firsts[walk.top];
    walk.count = walk.counts[walk.top];
    wait(i);
  };
  for (std::uint32_t i = 0; i < count && start(&walks[i]); ++i) wait(i);
  while ((at_nodes | at_leaves) != 0) {
    for (std::uint32_t turn = std::exchange(at_nodes, 0); turn != 0; turn &= turn - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(turn));
      tests += open_for_ray(tree, axes, &walks[i]);
      go_on(i);
    }
    for (std::uint32_t turn = std::exchange(at_leaves, 0); turn != 0; turn &= turn - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(turn));
      leaf(walks[i]);
      go_on(i);
    }
  }
  return tests;
}
