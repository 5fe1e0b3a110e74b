// Lists of a stream's rays, from node to node. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

/// Appends the numbers of a group's lanes that are set; room for kBundleWidth is needed. Returns
/// the new end.
HWY_INLINE std::uint32_t* append_set(const std::uint32_t* numbers, RM set_lanes,
                                     std::uint32_t* out) {
#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
  const RayInts d;
  auto kept = hn::Load(d, numbers);
  const std::uint32_t count = compress(d, hn::RebindMask(d, set_lanes), &kept);
  hn::StoreU(kept, d, out);
  return out + count;
#else
  std::uint32_t bits = bits_of(Rays(), set_lanes);
  for (; bits != 0; bits &= bits - 1) *out++ = numbers[__builtin_ctz(bits)];
  return out;
#endif
}

/// Appends `first` + the number of each of a bundle's lanes that are set; room for kBundleWidth
/// more is needed. Returns the new end.
HWY_INLINE std::uint32_t* append_lanes(std::uint32_t first, std::uint32_t lanes,
                                       std::uint32_t* out) {
  alignas(64) static constexpr std::uint32_t kLanes[kBundleWidth] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                     8, 9, 10, 11, 12, 13, 14, 15};
  const RayInts d;
  alignas(64) std::uint32_t numbers[kBundleWidth];
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
    hn::Store(hn::Add(hn::Set(d, first), hn::Load(d, kLanes + g)), d, numbers + g);
  for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
    out = append_set(numbers + g, lanes_of(lanes, g), out);
  return out;
}

/// A box as the rays of a stream see it: the planes that they meet first, and the others.
struct SeenBox {
  float x_near, x_far, y_near, y_far, z_near, z_far;
};

/// What boxes are tested with, of as many rays as a vector has lanes.
struct SlabRays {
  RV ox, oy, oz, per_x, per_y, s_near, s_far;
};

/// What triangles are tested with, of as many rays.
struct LeafRays {
  RV ox, oy, oz, t_limit, shear_x, shear_y, shear_z, t_min;
};

/// The lanes that meet the box within [s_near, s_far].
HWY_INLINE RM meeting(const SlabRays& r, const SeenBox& box) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  const RV x0 = Mul(Sub(set(box.x_near), r.ox), r.per_x);
  const RV x1 = Mul(Sub(set(box.x_far), r.ox), r.per_x);
  const RV y0 = Mul(Sub(set(box.y_near), r.oy), r.per_y);
  const RV y1 = Mul(Sub(set(box.y_far), r.oy), r.per_y);
  const RV near = Max(Max(x0, y0), Max(Sub(set(box.z_near), r.oz), r.s_near));
  const RV far = Min(Min(x1, y1), Min(Sub(set(box.z_far), r.oz), r.s_far));
  return hn::Le(near, far);
}

/// Lists at a leaf that are no longer take some rays with four triangles at once, instead of as
/// many rays as there are lanes with one.
inline constexpr std::uint32_t kFewAtQuads = 8;

template <class Mode>
class StreamLists : protected StreamSingles<Mode> {
 protected:
  using StreamHits<Mode>::tree_, StreamHits<Mode>::stream_, StreamHits<Mode>::counts_;
  using StreamHits<Mode>::prefetch_ray;
  using StreamSingles<Mode>::walk_singles_of_stream;

  explicit StreamLists(const TraceJob& job) : StreamSingles<Mode>(job), subtrees_(tree_) {}

  /// What comes next for the rays of a list.
  void meet(const WaitingList& list) {
    if (is_for_singles(list)) {
      add_singles(list);
      return;
    }
    if (has_many_singles()) walk_singles_of_stream();
    if (list.count != 0) {
      meet_leaf(list);
    } else {
      open(list);
    }
  }

  /// Numbers beyond a list's end, so that its last block is read like the others.
  void pad_list(std::uint32_t offset, std::uint32_t size) {
    std::uint32_t* end = stream_.lists.data() + offset + size;
    const RayInts d;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
      hn::StoreU(hn::Set(d, end[-1]), d, end + g);
  }

  /// The children from far to near along the stream's axis. A child's place is how many come before
  /// it, found without a branch that nobody can foretell.
  HWY_INLINE std::uint32_t sorted_children(const BvhNode& node, std::uint32_t* children) const {
    const Boxes d;
    const Numbers du;
    alignas(32) static constexpr std::uint32_t kNumbers[kBvhWidth] = {0, 1, 2, 3, 4, 5, 6, 7};
    alignas(32) float near[kBvhWidth];
    alignas(32) std::uint32_t places[kBvhWidth];
    const float* const row = node.bound[stream_.axis_z + (stream_.mirrored ? 3 : 0)];
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
      const BV at = hn::Load(d, row + g);
      hn::Store(stream_.mirrored ? hn::Neg(at) : at, d, near + g);
    }
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
      const BV at = hn::Load(d, near + g);
      const auto numbers = hn::Load(du, kNumbers + g);
      auto place = hn::Zero(du);
      for (std::uint32_t c = 0; c < node.children; ++c) {
        const BV other = hn::Set(d, near[c]);
        const auto earlier = hn::RebindMask(d, hn::Gt(numbers, hn::Set(du, c)));
        const auto before = hn::Or(hn::Gt(other, at), hn::And(hn::Eq(other, at), earlier));
        place = hn::Sub(place, hn::VecFromMask(du, hn::RebindMask(du, before)));
      }
      hn::Store(place, du, places + g);
    }
    for (std::uint32_t c = 0; c < node.children; ++c) children[places[c]] = c;
    return node.children;
  }

  /// A child's, grown by the pad.
  [[nodiscard]] HWY_INLINE SeenBox box_of(const BvhNode& node, std::uint32_t c) const {
    const RayStream& s = stream_;
    const auto grown = [&](int row) { return node.bound[row][c] + (row < 3 ? -s.pad : s.pad); };
    SeenBox box{grown(s.near_x), grown(s.far_x),  grown(s.near_y),
                grown(s.far_y),  grown(s.near_z), grown(s.far_z)};
    if (s.mirrored) {
      box.z_near = -box.z_near;
      box.z_far = -box.z_far;
    }
    return box;
  }

  /// Rays of the block after the next; at a list's beginning of the next, too.
  HWY_INLINE void prefetch_rays(const WaitingList& list, std::uint32_t base) const {
    const std::uint32_t* const numbers = stream_.lists.data() + list.offset;
    const std::uint32_t end = std::min(base + 3 * kBundleWidth, list.size);
    for (std::uint32_t i = base + (base == 0 ? 1 : 2) * kBundleWidth; i < end; ++i)
      prefetch_ray(numbers[i]);
  }

  void meet_leaf(const WaitingList& list) {
    const RayStream& s = stream_;
    counts_.triangle_tests += std::uint64_t{list.size} * list.count;
    if (list.size <= kFewAtQuads) return meet_leaf_by_quads(list);
    const std::uint32_t* numbers = s.lists.data() + list.offset;
    for (std::uint32_t base = 0; base < list.size; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, list.size - base);
      const std::uint32_t* block = numbers + base;
      const std::uint32_t used = n == kBundleWidth ? 0xffffu : (1u << n) - 1;
      prefetch_rays(list, base);
      for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
        meet_group(4 * list.first, list.count, block, used, g);
    }
  }

  /// The same, some rays with four triangles at once.
  HWY_NOINLINE void meet_leaf_by_quads(const WaitingList& list) {
    const SharedAxes axes(stream_);
    const std::uint32_t* numbers = stream_.lists.data() + list.offset;
    QuadHits hits;
    for (std::uint32_t n = 0; n < list.count; n += kQuadTriangles) {
      const TriangleQuad* const quad = &tree_.quads[list.first + n / kQuadTriangles];
      meet_quads(
          axes, list.size,
          [&](std::uint32_t i) HWY_ATTR { return stream_.rays.data() + numbers[i]; },
          [&](std::uint32_t) HWY_ATTR { return quad; }, &hits);
      const std::uint32_t here = std::min(kQuadTriangles, list.count - n);
      const std::uint64_t used = ((std::uint64_t{1} << here) - 1) * 0x1111111111111111u &
                                 ((std::uint64_t{1} << 4 * list.size) - 1);
      const std::uint32_t place = 4 * list.first + n;
      for (std::uint64_t turn = hits.hit & used; turn != 0; turn &= turn - 1) {
        const std::uint32_t b = first_of(turn);
        take(numbers[b / 4], place + b % 4, hits.at(b), hits.is_front(b));
      }
      for (std::uint64_t turn = hits.unsettled & used; turn != 0; turn &= turn - 1) {
        const std::uint32_t b = first_of(turn);
        settle(numbers[b / 4], place + b % 4);
      }
    }
  }

  /// Triangles from a place on with the lanes of a block from `g` on.
  HWY_INLINE void meet_group(std::uint32_t first, std::uint32_t count, const std::uint32_t* block,
                             std::uint32_t used, std::size_t g) {
    LeafRays r;
    gather4(stream_.rays.data(), 0, block + g, r.ox, r.oy, r.oz, r.t_limit);
    gather4(stream_.rays.data(), 1, block + g, r.shear_x, r.shear_y, r.shear_z, r.t_min);
    meet_triangles(first, count, r, [&](std::uint32_t place, const Tested<Rays>& tested) HWY_ATTR {
      take_lanes(place, block, used, g, tested);
    });
  }

  /// Calls `met(place, tested)` for those of the triangles that some ray may hit.
  template <class Met>
  HWY_INLINE void meet_triangles(std::uint32_t first, std::uint32_t count, const LeafRays& r,
                                 const Met& met) const {
    const Rays d;
    const RayStream& s = stream_;
    for (std::uint32_t place = first; place < first + count; ++place) {
      const TriangleQuad& q = tree_.quads[place / 4];
      const std::uint32_t k = place % 4;
      const float* x = &q.vertex[0][s.axis_x][k];
      const float* y = &q.vertex[0][s.axis_y][k];
      const float* z = &q.vertex[0][s.axis_z][k];
      const auto moved = [&](int c) {
        return sheared(d, hn::Sub(set(x[12 * c]), r.ox), hn::Sub(set(y[12 * c]), r.oy),
                       hn::Sub(set(z[12 * c]), r.oz), r.shear_x, r.shear_y);
      };
      Tested<Rays> tested;
      if (test_lanes(d, moved(0), moved(1), moved(2), set(q.reach[k]), r.shear_z, r.t_min,
                     r.t_limit, &tested))
        met(place, tested);
    }
  }

 private:
  using StreamHits<Mode>::take, StreamHits<Mode>::settle, StreamHits<Mode>::take_lanes;
  using StreamSingles<Mode>::is_for_singles, StreamSingles<Mode>::has_many_singles;
  using StreamSingles<Mode>::add_singles;

  void open(const WaitingList& list) {
    RayStream& s = stream_;
    const BvhNode& node = tree_.nodes[list.first];
    std::uint32_t children[kBvhWidth];
    const std::uint32_t child_count = sorted_children(node, children);
    counts_.ray_box_tests += std::uint64_t{list.size} * child_count;
    const std::uint32_t room = (list.size + kBundleWidth + 15) / 16 * 16;
    const std::uint32_t bottom = (list.offset + list.size + 15) / 16 * 16;
    const std::size_t needed = bottom + std::size_t{room} * child_count + 2 * kBundleWidth;
    s.grow_lists(needed);
    SeenBox boxes[kBvhWidth];
    std::uint32_t* out[kBvhWidth];
    for (std::uint32_t k = 0; k < child_count; ++k) {
      boxes[k] = box_of(node, children[k]);
      out[k] = s.lists.data() + bottom + room * k;
    }
    const RV nowhere = set(-std::numeric_limits<float>::infinity());
    const std::uint32_t* numbers = s.lists.data() + list.offset;
    for (std::uint32_t base = 0; base < list.size; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, list.size - base);
      const std::uint32_t* block = numbers + base;
      const std::uint32_t used = n == kBundleWidth ? 0xffffu : (1u << n) - 1;
      prefetch_rays(list, base);
      for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
        SlabRays rays;
        RV unused;
        gather4(s.rays.data(), 0, block + g, rays.ox, rays.oy, rays.oz, unused);
        gather4(s.rays.data(), 2, block + g, rays.per_x, rays.per_y, rays.s_near, rays.s_far);
        if (s.mirrored) rays.oz = hn::Neg(rays.oz);
        rays.s_far = hn::IfThenElse(lanes_of(used, g), rays.s_far, nowhere);
        for (std::uint32_t k = 0; k < child_count; ++k)
          out[k] = append_set(block + g, meeting(rays, boxes[k]), out[k]);
      }
    }
    for (std::uint32_t k = 0; k < child_count; ++k) {
      const std::uint32_t offset = bottom + room * k;
      const auto size = static_cast<std::uint32_t>(out[k] - (s.lists.data() + offset));
      if (size == 0) continue;
      pad_list(offset, size);
      const std::uint32_t c = children[k];
      s.waiting.push_back({node.first[c], node.count[c], offset, size});
      subtrees_.prefetch(node.first[c], node.count[c]);
    }
  }

 protected:
  const Subtrees subtrees_;
};
