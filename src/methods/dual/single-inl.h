// Rays that go on alone through subtrees, eight boxes at a time: where few are left to share one.
// Included once a SIMD target by methods/dual/trace_simd.cpp, inside its namespace.

/// Where subtrees stand, so that what comes next is prefetched without a branch that nobody can
/// foretell: a node has four cache lines, a quad three.
class Subtrees {
 public:
  explicit Subtrees(const ObjectTree& tree)
      : kinds_{{reinterpret_cast<const char*>(tree.nodes.data()), sizeof(BvhNode), 192},
               {reinterpret_cast<const char*>(tree.quads.data()), sizeof(TriangleQuad), 128}} {}

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
/// Eight numbers, the largest first, by a bitonic network: which of a node's boxes a ray meets, and
/// in which order, no branch can foretell. `few`: the last four are 0.
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

/// Tests the boxes of the node that is next and puts those that are met on the stack: `kSorted`:
/// the nearest on top, to within a part in 2^19. Returns the boxes tested.
template <bool kSorted>
HWY_INLINE std::uint32_t open_for_ray(const ObjectTree& tree, const SharedAxes& a,
                                      SingleWalks* walks, std::uint32_t i) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  // A key: where the box is entered, and its number in the bits below. Of boxes not met: 0.
  constexpr std::uint32_t kNearBits = 0x7ffffff0, kMet = 8, kChild = 7;
  const Boxes d;
  const Numbers du;
  const StreamRay& r = *walks->ray[i];
  const BvhNode& node = tree.nodes[walks->first[i]];
  alignas(32) static constexpr std::uint32_t kNumbers[kBvhWidth] = {8, 9, 10, 11, 12, 13, 14, 15};
  if (HWY_UNLIKELY(!walks->has_room(i))) walks->grow();
  float* const nears = walks->nears(i) + walks->top[i];
  std::uint32_t* const firsts = walks->firsts(i) + walks->top[i];
  std::uint32_t* const counts = walks->counts(i) + walks->top[i];
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

/// The lowest bit that is set.
HWY_INLINE std::uint32_t first_of(std::uint64_t bits) {
  return static_cast<std::uint32_t>(__builtin_ctzll(bits));
}

/// Bit i: numbers[i] is 0.
HWY_INLINE std::uint32_t zeros_of(const std::uint32_t* numbers) {
  const hn::CappedTag<std::uint32_t, SingleWalks::kMost> d;
  std::uint32_t zeros = 0;
  for (std::size_t g = 0; g < SingleWalks::kMost; g += hn::Lanes(d))
    zeros |= bits_of(d, hn::Eq(hn::Load(d, numbers + g), hn::Zero(d))) << g;
  return zeros;
}

/// Rays through their subtrees, near boxes first, taking turns: while one waits for memory the
/// others go on. A round has a loop for each thing that there is to do, over those that do it,
/// instead of a branch for each ray that nobody can foretell: nodes, quads, hits, what is next.
/// `start(i)` gives walk i its next ray, or says that there is none; `take(i, place, t, front)`
/// hands over a hit and `settle(i, place)` what may be one, after which the ray may see less far
/// where `kShrinks`.
template <bool kShrinks, class Start, class Take, class Settle>
HWY_NOINLINE void walk_singles(const ObjectTree& tree, const SharedAxes& axes, SingleWalks* walks,
                               std::uint32_t count, const Start& start, const Take& take,
                               const Settle& settle, DualCounts* tests) {
  QuadHits hits;
  std::uint32_t at[SingleWalks::kMost + kQuadRays];
  std::uint64_t boxes = 0, triangles = 0;
  std::uint32_t active = 0;
  const Subtrees subtrees(tree);
  const auto prefetch = [&](std::uint32_t i) __attribute__((always_inline)) {
    subtrees.prefetch(walks->first[i], walks->count[i]);
  };
  const auto start_next = [&](std::uint32_t i) __attribute__((always_inline)) {
    if (!start(i)) return;
    active |= 1u << i;
    prefetch(i);
  };
  for (std::uint32_t i = 0; i < count; ++i) start_next(i);
  while (active != 0) {
    const std::uint32_t at_nodes = zeros_of(walks->count) & active;
    for (std::uint32_t turn = at_nodes; turn != 0; turn &= turn - 1)
      boxes += open_for_ray<kShrinks>(tree, axes, walks, first_of(turn));

    std::uint32_t leaves = 0, longer = 0, met = 0;
    std::uint64_t used = 0;
    for (std::uint32_t turn = active & ~at_nodes; turn != 0; turn &= turn - 1) {
      const std::uint32_t i = first_of(turn), here = std::min(kQuadTriangles, walks->count[i]);
      triangles += here;
      used |= ((std::uint64_t{1} << here) - 1) << 4 * leaves;
      longer |= (walks->count[i] > kQuadTriangles ? 1u : 0u) << i;
      at[leaves++] = i;
    }
    if (leaves != 0) {
      for (std::uint32_t i = 1; i < kQuadRays; ++i) at[leaves + i - 1] = at[leaves - 1];
      meet_quads(
          axes, leaves, [&](std::uint32_t n) HWY_ATTR { return walks->ray[at[n]]; },
          [&](std::uint32_t n) HWY_ATTR { return &tree.quads[walks->first[at[n]]]; }, &hits);
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

    const std::uint32_t going = active & ~longer, empty = zeros_of(walks->top) & going;
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
