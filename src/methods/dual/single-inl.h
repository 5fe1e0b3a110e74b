// Traces single rays through subtrees, eight boxes at a time: where few rays share one. Random rays
// take 1.2 times as long without this way. Included once for each SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

/// A ray for box tests: its origin, moved as far as planes are moved outwards, and the s of a unit
/// across, rounded down and up (methods/dual/bundle16.h).
struct SingleSlabs {
  float x_near, x_far, y_near, y_far, z_near, z_far;
  float per_x_near, per_x_far, per_y_near, per_y_far;

  SingleSlabs() = default;
  SingleSlabs(const StreamRay& r, const RayStream& s)
      : SingleSlabs(r, s, s.growth, s.are_far ? r.t_min : 0) {}
  /// `pad`: by which boxes grow besides.
  SingleSlabs(const StreamRay& r, const QuarterAxes& s, const Growth& growth, float pad) {
    // A lower plane moves down if the origin moves up; an upper plane is the opposite.
    const auto apart = [](float from, float by, int near_row, float* near, float* far) {
      *near = near_row < 3 ? from + by : from - by;
      *far = near_row < 3 ? from - by : from + by;
    };
    apart(r.ox, growth.of(r.ox) + pad, s.near_x, &x_near, &x_far);
    apart(r.oy, growth.of(r.oy) + pad, s.near_y, &y_near, &y_far);
    apart(r.oz, growth.of(r.oz) + pad, s.near_z, &z_near, &z_far);
    constexpr float kHalf = 6 * kUnitRoundoff;
    static_assert(kFarther == 1 + 2 * kHalf);
    per_x_near = r.per_x * (1 - kHalf), per_x_far = r.per_x * (1 + kHalf);
    per_y_near = r.per_y * (1 - kHalf), per_y_far = r.per_y * (1 + kHalf);
  }
};

/// Interleaved rays on their way through subtrees: walk i continues at `first[i]`, and its stack
/// holds its other subtrees, the nearest on top. A walk that has gone down from one tree into
/// another has those of the other from `base[i]` on.
struct SingleWalks {
  static constexpr std::uint32_t kMost = 16;

  SingleWalks() = default;
  SingleWalks(const SingleWalks&) = delete;
  SingleWalks& operator=(const SingleWalks&) = delete;

  const StreamRay* ray[kMost];
  SingleSlabs slabs[kMost];
  std::uint32_t number[kMost];  ///< the caller's number of the ray
  alignas(64) std::uint32_t first[kMost] = {}, count[kMost] = {};  ///< next subtree, as in BvhNode
  alignas(64) std::uint32_t top[kMost] = {};                       ///< size of the stack
  alignas(64) std::uint32_t base[kMost] = {};

  void start(std::uint32_t i, std::uint32_t begin, std::uint32_t triangles) {
    first[i] = begin;
    count[i] = triangles;
    top[i] = base[i] = 0;
  }
  /// Goes down to the root of another tree.
  void descend(std::uint32_t i) {
    first[i] = count[i] = 0;
    base[i] = top[i];
  }
  [[nodiscard]] float* nears(std::uint32_t i) { return nears_.of(i, room_); }
  [[nodiscard]] std::uint32_t* firsts(std::uint32_t i) { return firsts_.of(i, room_); }
  [[nodiscard]] std::uint32_t* counts(std::uint32_t i) { return counts_.of(i, room_); }
  [[nodiscard]] bool has_room(std::uint32_t i) const { return top[i] + kBvhWidth <= room_; }
  HWY_NOINLINE void grow() {
    nears_.grow(room_);
    firsts_.grow(room_);
    counts_.grow(room_);
    room_ *= 2;
  }
  void pop(std::uint32_t i) {
    const std::uint32_t last = --top[i];
    first[i] = firsts(i)[last];
    count[i] = counts(i)[last];
  }
  /// Removes subtrees that the ray no longer reaches, and keeps the order.
  void drop_beyond(std::uint32_t i, float s_far) {
    float* const near = nears(i);
    std::uint32_t* const next = firsts(i);
    std::uint32_t* const triangles = counts(i);
    std::uint32_t kept = base[i];
    for (std::uint32_t k = kept; k < top[i]; ++k) {
      near[kept] = near[k];
      next[kept] = next[k];
      triangles[kept] = triangles[k];
      kept += near[kept] <= s_far ? 1 : 0;
    }
    top[i] = kept;
  }

 private:
  static constexpr std::size_t kRoom = 64;  ///< of a stack before it grows

  /// A column of all stacks, which needs no allocation until it grows.
  template <class T>
  class Column {
   public:
    [[nodiscard]] T* of(std::size_t i, std::size_t room) { return at_ + i * room; }
    void grow(std::size_t room) {
      std::vector<T> larger(2 * kMost * room);
      for (std::size_t i = 0; i < kMost; ++i)
        std::copy_n(of(i, room), room, larger.data() + 2 * i * room);
      grown_.swap(larger);
      at_ = grown_.data();
    }

   private:
    T own_[kMost * kRoom];
    std::vector<T> grown_;
    T* at_ = own_;
  };

  std::size_t room_ = kRoom;
  Column<float> nears_;  ///< where the ray enters the box
  Column<std::uint32_t> firsts_, counts_;
};

// Rays with a quad of triangles each, several rays at once.

/// Number of rays at once: as many as a vector has blocks of four lanes; on short vectors one ray,
/// with a part of its quad at a time.
inline constexpr std::uint32_t kQuadRays = std::max<std::uint32_t>(1, hn::MaxLanes(Rays()) / 4);

/// Tests kQuadRays rays, each along its axes, with a quad each, with its triangles from `g` on:
/// lane 4 i + k is ray i and triangle g + k.
HWY_INLINE void test_quads(const QuarterAxes* const* axes, bool are_far,
                           const StreamRay* const* ray, const TriangleQuad* const* quad,
                           std::size_t g, Tested<Rays>* tested) {
  const Rays d;
  const float *x[kQuadRays], *y[kQuadRays], *z[kQuadRays];
  for (std::uint32_t i = 0; i < kQuadRays; ++i) {
    const auto& corner = quad[i]->vertex[0];
    x[i] = corner[axes[i]->axis_x] + g;
    y[i] = corner[axes[i]->axis_y] + g;
    z[i] = corner[axes[i]->axis_z] + g;
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
    return load_blocks(
        d, [&](std::size_t k) __attribute__((always_inline)) { return axis[k] + 12 * i; });
  };
  const RV reach = load_blocks(
      d, [&](std::size_t i) __attribute__((always_inline)) { return quad[i]->reach + g; });
  const RV o = load_blocks(
      d, [&](std::size_t i) __attribute__((always_inline)) { return &ray[i]->ox; });
  const RV s = load_blocks(
      d, [&](std::size_t i) __attribute__((always_inline)) { return &ray[i]->shear_x; });
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
  if (HWY_UNLIKELY(are_far)) return test_far_lanes(d, c0, c1, c2, reach, t_min, tested);
  finish_lanes(d, c0, c1, c2, edges_of(d, c0, c1, c2, reach), reach, shear_z, t_min, t_limit,
               tested);
}

/// The results of rays with a quad each: bit 4 i + k of `hit` is ray i and triangle k; `unsettled`
/// has the bits that stage 2 must decide.
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

/// Tests `count` rays, at most kMost, without a branch, because it is unpredictable whether a ray
/// hits any triangle of its quad. `axes_at(i)`, `ray_at(i)` and `quad_at(i)` must also be valid for
/// kQuadRays - 1 more rays.
template <class AxesAt, class RayAt, class QuadAt>
HWY_INLINE void meet_quads(bool are_far, std::uint32_t count, const AxesAt& axes_at,
                           const RayAt& ray_at, const QuadAt& quad_at, QuadHits* hits) {
  hits->hit = hits->unsettled = hits->front = 0;
  for (std::uint32_t base = 0; base < count; base += kQuadRays) {
    const QuarterAxes* axes[kQuadRays];
    const StreamRay* ray[kQuadRays];
    const TriangleQuad* quad[kQuadRays];
    for (std::uint32_t i = 0; i < kQuadRays; ++i) {
      axes[i] = axes_at(base + i);
      ray[i] = ray_at(base + i);
      quad[i] = quad_at(base + i);
    }
    for (std::size_t g = 0; g < 4; g += ray_lanes()) {
      Tested<Rays> tested;
      test_quads(axes, are_far, ray, quad, g, &tested);
      hits->keep(tested, 4 * base + g);
    }
  }
}

// One ray, or sixteen interleaved, down a subtree.

/// Addresses of subtrees, so that the next one is prefetched without an unpredictable branch: a
/// node has four cache lines, a quad three.
class Subtrees {
 public:
  Subtrees() = default;
  explicit Subtrees(const ObjectTree& tree) : Subtrees(tree.nodes.data(), tree.quads.data()) {}
  /// Three cache lines of each leaf are read.
  template <class Leaf>
  Subtrees(const BvhNode* nodes, const Leaf* leaves)
      : kinds_{{reinterpret_cast<const char*>(nodes), sizeof(BvhNode), 192},
               {reinterpret_cast<const char*>(leaves), sizeof(Leaf), 128}} {}

  HWY_INLINE void prefetch(std::uint32_t first, std::uint32_t count) const {
    const Kind& kind = kinds_[count != 0 ? 1 : 0];
    const char* const at = kind.base + first * kind.bytes;
    hwy::Prefetch(at);
    hwy::Prefetch(at + 64);
    hwy::Prefetch(at + 128);
    hwy::Prefetch(at + kind.last);
  }

 private:
  struct Kind {
    const char* base;
    std::size_t bytes, last;
  };
  Kind kinds_[2];
};

using Numbers = hn::RebindToUnsigned<Boxes>;

#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
/// Sorts eight numbers, largest first, by a bitonic network, because no branch predictor knows
/// which boxes a ray intersects and in which order. `few`: the last four are 0.
HWY_INLINE hn::Vec<Numbers> sorted_down(hn::Vec<Numbers> v, bool few) {
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
  if (HWY_LIKELY(few)) return v;
  const auto other = hn::Reverse8(d, v);
  v = hn::OddEvenBlocks(hn::Min(v, other), hn::Max(v, other));
  by_twos(hn::Shuffle1032(v));
  by_ones();
  return v;
}
#endif

/// Tests the boxes of a ray's next node and pushes the intersected ones on its stack. `kSorted`:
/// with the nearest on top, to a precision of 1 in 2^19. Returns the number of boxes tested.
template <bool kSorted>
HWY_INLINE std::uint32_t open_for_ray(const BvhNode& node, const QuarterAxes& a, SingleWalks* walks,
                                      std::uint32_t i) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  // A key consists of where the ray enters the box and, in the bits below, the box's number. It is
  // 0 for boxes that the ray misses.
  constexpr std::uint32_t kNearBits = 0x7ffffff0, kMet = 8, kChild = 7;
  const Boxes d;
  const Numbers du;
  const StreamRay& r = *walks->ray[i];
  const SingleSlabs& s = walks->slabs[i];
  const float per_z = a.mirrored ? -1.0f : 1.0f;
  alignas(32) static constexpr std::uint32_t kNumbers[kBvhWidth] = {8, 9, 10, 11, 12, 13, 14, 15};
  if (HWY_UNLIKELY(!walks->has_room(i))) walks->grow();
  float* const nears = walks->nears(i) + walks->top[i];
  std::uint32_t* const firsts = walks->firsts(i) + walks->top[i];
  std::uint32_t* const counts = walks->counts(i) + walks->top[i];
  const auto clip = [&](std::size_t g, BV * near, BV * far) __attribute__((always_inline)) {
    const auto at = [&](int row, float from, float per) __attribute__((always_inline)) {
      return Mul(Sub(hn::Load(d, node.bound[row] + g), hn::Set(d, from)), hn::Set(d, per));
    };
    *near = Max(Max(at(a.near_x, s.x_near, s.per_x_near), at(a.near_y, s.y_near, s.per_y_near)),
                Max(at(a.near_z, s.z_near, per_z), hn::Set(d, r.s_near)));
    *far = Min(Min(at(a.far_x, s.x_far, s.per_x_far), at(a.far_y, s.y_far, s.per_y_far)),
               Min(at(a.far_z, s.z_far, per_z), hn::Set(d, r.s_far)));
  };
  BV near, far;
#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
  clip(0, &near, &far);
  const auto met = hn::RebindMask(du, hn::Le(near, far));
  auto keys = hn::Load(du, kNumbers);
  if constexpr (kSorted)
    keys = hn::Or(keys, hn::And(hn::BitCast(du, near), hn::Set(du, kNearBits)));
  keys = hn::IfThenElseZero(met, keys);
  const std::uint32_t found = compress(du, met, &keys);
  if constexpr (kSorted) keys = sorted_down(keys, found <= 4);
  const auto children = hn::And(keys, hn::Set(du, kChild));
  const auto order = hn::IndicesFromVec(du, children);
  const hn::Rebind<std::uint8_t, Numbers> d8;
  hn::StoreU(hn::TableLookupLanes(near, hn::IndicesFromVec(d, children)), d, nears);
  hn::StoreU(hn::TableLookupLanes(hn::Load(du, node.first), order), du, firsts);
  hn::StoreU(hn::TableLookupLanes(hn::PromoteTo(du, hn::LoadU(d8, node.count)), order), du, counts);
  walks->top[i] += found;
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
      for (; kSorted && place > 0 && keys[place - 1] < key; --place) keys[place] = keys[place - 1];
      keys[place] = key;
    }
  }
  static_cast<void>(du);
  for (std::uint32_t k = 0; k < end; ++k) {
    const std::uint32_t c = keys[k] & kChild;
    nears[k] = entered[c];
    firsts[k] = node.first[c];
    counts[k] = node.count[c];
  }
  walks->top[i] += end;
#endif
  static_assert(kMet == kBvhWidth);
  return node.children;
}

/// The index of the lowest set bit.
HWY_INLINE std::uint32_t first_of(std::uint64_t bits) {
  return static_cast<std::uint32_t>(__builtin_ctzll(bits));
}

/// Bit i is set if a[i] is b[i].
HWY_INLINE std::uint32_t equal_in(const std::uint32_t* a, const std::uint32_t* b) {
  const hn::CappedTag<std::uint32_t, SingleWalks::kMost> d;
  std::uint32_t equal = 0;
  for (std::size_t g = 0; g < SingleWalks::kMost; g += hn::Lanes(d))
    equal |= bits_of(d, hn::Eq(hn::Load(d, a + g), hn::Load(d, b + g))) << g;
  return equal;
}
/// Bit i is set if numbers[i] is 0.
HWY_INLINE std::uint32_t zeros_of(const std::uint32_t* numbers) {
  alignas(64) static constexpr std::uint32_t kZeros[SingleWalks::kMost] = {};
  return equal_in(numbers, kZeros);
}

/// One tree, and one quarter, for all walks.
class OneTree {
 public:
  static constexpr bool kTwoLevels = false;

  OneTree(const ObjectTree& tree, const RayStream& stream)
      : tree_(tree), stream_(stream), subtrees_(tree) {}

  [[nodiscard]] HWY_INLINE const BvhNode& node(std::uint32_t /*walk*/, std::uint32_t number) const {
    return tree_.nodes[number];
  }
  [[nodiscard]] HWY_INLINE const TriangleQuad& quad(std::uint32_t /*walk*/,
                                                    std::uint32_t number) const {
    return tree_.quads[number];
  }
  [[nodiscard]] HWY_INLINE const QuarterAxes& axes(std::uint32_t /*walk*/) const { return stream_; }
  [[nodiscard]] HWY_INLINE const Subtrees& subtrees(std::uint32_t /*walk*/) const {
    return subtrees_;
  }
  [[nodiscard]] HWY_INLINE bool are_far() const { return stream_.are_far; }

 private:
  const ObjectTree& tree_;
  const RayStream& stream_;
  const Subtrees subtrees_;
};

/// Traces rays through their subtrees, near boxes first, interleaved: while one waits for memory,
/// the others continue. Each round has one loop for each kind of work (nodes, quads, hits, next
/// subtree), over the rays that need it, instead of an unpredictable branch for each ray. `places`
/// has each walk's nodes, quads and axes, as `OneTree`; `start(i)` gives walk i its next ray, or
/// returns that there is none; `take(i, place, t, front)` receives a hit and `settle(i, place)` a
/// possible hit, after which the ray may be shorter if `kShrinks`.
///
/// With `Places::kTwoLevels` the leaves of some trees are other trees: `above()` has the bits of
/// walks in such a tree; `enter(i)` goes down into the tree at `first[i]`, or returns that the ray
/// misses it; `leave(i)` goes back up.
template <bool kShrinks, class Places, class Start, class Take, class Settle>
HWY_NOINLINE void walk_singles(Places&& places, SingleWalks* walks, std::uint32_t count,
                               const Start& start, const Take& take, const Settle& settle,
                               DualCounts* tests) {
  constexpr bool kTwoLevels = std::remove_cvref_t<Places>::kTwoLevels;
  QuadHits hits;
  std::uint32_t at[SingleWalks::kMost + kQuadRays];
  std::uint64_t boxes = 0, triangles = 0;
  std::uint32_t active = 0;
  const auto prefetch = [&](std::uint32_t i) __attribute__((always_inline)) {
    places.subtrees(i).prefetch(walks->first[i], walks->count[i]);
  };
  const auto start_next = [&](std::uint32_t i) __attribute__((always_inline)) {
    if (!start(i)) return;
    active |= 1u << i;
    prefetch(i);
  };
  for (std::uint32_t i = 0; i < count; ++i) start_next(i);
  while (active != 0) {
    const std::uint32_t at_nodes = zeros_of(walks->count) & active;
    for (std::uint32_t turn = at_nodes; turn != 0; turn &= turn - 1) {
      const std::uint32_t i = first_of(turn);
      boxes += open_for_ray<kShrinks>(places.node(i, walks->first[i]), places.axes(i), walks, i);
    }

    std::uint32_t at_leaves = active & ~at_nodes, entered = 0;
    if constexpr (kTwoLevels) {
      std::uint32_t turn = at_leaves & places.above();
      at_leaves &= ~turn;
      for (; turn != 0; turn &= turn - 1) {
        const std::uint32_t i = first_of(turn);
        if (!places.enter(i)) continue;
        entered |= 1u << i;
        prefetch(i);
      }
    }

    std::uint32_t leaves = 0, longer = 0, met = 0;
    std::uint64_t used = 0;
    for (std::uint32_t turn = at_leaves; turn != 0; turn &= turn - 1) {
      const std::uint32_t i = first_of(turn), here = std::min(kQuadTriangles, walks->count[i]);
      triangles += here;
      used |= ((std::uint64_t{1} << here) - 1) << 4 * leaves;
      longer |= (walks->count[i] > kQuadTriangles ? 1u : 0u) << i;
      at[leaves++] = i;
    }
    if (leaves != 0) {
      for (std::uint32_t i = 1; i < kQuadRays; ++i) at[leaves + i - 1] = at[leaves - 1];
      meet_quads(
          places.are_far(), leaves, [&](std::uint32_t n) HWY_ATTR { return &places.axes(at[n]); },
          [&](std::uint32_t n) HWY_ATTR { return walks->ray[at[n]]; },
          [&](std::uint32_t n) HWY_ATTR { return &places.quad(at[n], walks->first[at[n]]); },
          &hits);
      for (std::uint64_t turn = hits.hit & used; turn != 0; turn &= turn - 1) {
        const std::uint32_t b = first_of(turn), i = at[b / 4];
        met |= 1u << i;
        take(i, 4 * walks->first[i] + b % 4, hits.at(b), hits.is_front(b));
      }
      for (std::uint64_t turn = hits.unsettled & used; turn != 0; turn &= turn - 1) {
        const std::uint32_t b = first_of(turn), i = at[b / 4];
        met |= 1u << i;
        settle(i, 4 * walks->first[i] + b % 4);
      }
    }
    for (; kShrinks && met != 0; met &= met - 1) {
      const std::uint32_t i = first_of(met);
      walks->drop_beyond(i, walks->ray[i]->s_far);
    }

    std::uint32_t going = active & ~longer & ~entered;
    if constexpr (kTwoLevels) {
      for (std::uint32_t turn = equal_in(walks->top, walks->base) & going & ~places.above();
           turn != 0; turn &= turn - 1)
        places.leave(first_of(turn));
    }
    const std::uint32_t empty = zeros_of(walks->top) & going;
    for (; longer != 0; longer &= longer - 1) {
      const std::uint32_t i = first_of(longer);
      walks->first[i] += 1;
      walks->count[i] -= kQuadTriangles;
    }
    for (std::uint32_t turn = going & ~empty; turn != 0; turn &= turn - 1) {
      const std::uint32_t i = first_of(turn);
      walks->pop(i);
      prefetch(i);
    }
    active &= ~empty;
    for (std::uint32_t turn = empty; turn != 0; turn &= turn - 1) start_next(first_of(turn));
  }
  tests->ray_box_tests += boxes;
  tests->triangle_tests += triangles;
}
