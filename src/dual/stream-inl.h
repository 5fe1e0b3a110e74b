// Streams of rays through the tree. Included by dual/trace_simd.cpp, inside its namespace.

/// Appends the numbers of a group's lanes that are set; room for kPacketWidth is needed. Returns
/// the new end.
HWY_INLINE std::uint32_t* append_set(const std::uint32_t* numbers, RM set_lanes,
                                     std::uint32_t* out) {
#if HWY_TARGET <= HWY_AVX3
  const RayInts d;
  const auto lanes = hn::RebindMask(d, set_lanes);
  hn::StoreU(hn::Compress(hn::Load(d, numbers), lanes), d, out);
  return out + hn::CountTrue(d, lanes);
#else
  std::uint32_t bits = bits_of(Rays(), set_lanes);
  for (; bits != 0; bits &= bits - 1) *out++ = numbers[__builtin_ctz(bits)];
  return out;
#endif
}

/// Fewer rays send no pilots: they would go alone.
inline constexpr std::uint32_t kFewestPiloted = 512;

template <class Mode>
class StreamWalk : StreamSingles<Mode> {
 public:
  explicit StreamWalk(const TraceJob& job) : StreamSingles<Mode>(job) {}

  /// Rays [first, first + count) of the order, of one quarter, at most kStreamRays.
  void run(std::uint32_t first, std::uint32_t count, std::uint32_t quarter) {
    const DualCounts before = counts_;
    std::uint32_t alive = fill(first, count, quarter);
    if constexpr (Mode::kAny) {
      if (alive >= kFewestPiloted) alive = follow_pilots(alive);
    }
    walk(0, alive);
    if (HWY_UNLIKELY(!unbounded_.empty())) test_unbounded();
    write_back();
    if (job_.ray_tests != nullptr) {
      const float share =
          static_cast<float>(counts_.sum() - before.sum()) / static_cast<float>(count);
      for (std::uint32_t i = 0; i < count; ++i) job_.ray_tests[stream_.index[i]] += share;
    }
  }

  /// Hands over what was counted and found for packets [begin, end).
  void finish(std::size_t begin, std::size_t end) {
    if constexpr (Mode::kAll) hand_over_rows(job_, begin, end, stream_.rows);
    const std::lock_guard<std::mutex> lock(*job_.mutex);
    if (job_.counts != nullptr) job_.counts->add(counts_);
  }

 private:
  using StreamHits<Mode>::job_, StreamHits<Mode>::tree_, StreamHits<Mode>::stream_;
  using StreamHits<Mode>::counts_;
  using StreamHits<Mode>::take_lanes, StreamHits<Mode>::write_back;
  using StreamSingles<Mode>::is_for_singles, StreamSingles<Mode>::has_many_singles;
  using StreamSingles<Mode>::add_singles, StreamSingles<Mode>::walk_singles_of_stream;

  /// The rays of a list through the tree.
  void walk(std::uint32_t offset, std::uint32_t size) {
    if (size == 0) return;
    stream_.waiting.clear();
    stream_.waiting.push_back({0, 0, offset, size});
    while (!stream_.waiting.empty()) {
      const WaitingList next = stream_.waiting.back();
      stream_.waiting.pop_back();
      if (is_for_singles(next)) {
        add_singles(next);
        continue;
      }
      if (has_many_singles()) walk_singles_of_stream();
      if (next.count != 0) {
        meet_leaf(next);
      } else {
        open(next);
      }
    }
    walk_singles_of_stream();
  }

  /// What stops a ray often stops those beside it (E. Haines, D. Greenberg, "The Light Buffer",
  /// 1986, keep the last occluder). Of each block of the list one ray goes ahead, and the triangles
  /// that stopped it and its neighbours' are tried on the block. Returns how many of the first
  /// `alive` of the list are left.
  std::uint32_t follow_pilots(std::uint32_t alive) {
    Stream& s = stream_;
    const std::uint32_t blocks = alive / kPacketWidth, pilots = (alive + 31) / 16 * 16;
    s.grow_lists(pilots + blocks + std::size_t{2} * kPacketWidth);
    for (std::uint32_t b = 0; b < blocks; ++b)
      s.lists[pilots + b] = s.lists[b * kPacketWidth + kPacketWidth / 2];
    pad_list(pilots, blocks);
    walk(pilots, blocks);
    std::uint32_t* const numbers = s.lists.data();
    places_.assign(blocks + std::size_t{2}, kInvalidId);
    for (std::uint32_t b = 0; b < blocks; ++b) {
      const std::uint32_t pilot = numbers[b * kPacketWidth + kPacketWidth / 2];
      places_[b + 1] = s.hits[pilot].triangle;
      s.rays[pilot].s_far = -std::numeric_limits<float>::infinity();  // done, hit or not
    }
    std::uint32_t left = 0;
    for (std::uint32_t b = 0; b * kPacketWidth < alive; ++b) {
      const std::uint32_t first = b * kPacketWidth, n = std::min(kPacketWidth, alive - first);
      const std::uint32_t before = places_[b], middle = b < blocks ? places_[b + 1] : before;
      const std::uint32_t after = b < blocks ? places_[b + 2] : before;
      if (middle != kInvalidId) try_on_block(middle, numbers + first, n);
      if (before != kInvalidId && before != middle) try_on_block(before, numbers + first, n);
      if (after != kInvalidId && after != middle && after != before)
        try_on_block(after, numbers + first, n);
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t number = numbers[first + i];
        numbers[left] = number;
        left += s.rays[number].s_far >= s.rays[number].s_near ? 1 : 0;
      }
    }
    if (left != 0) pad_list(0, left);
    return left;
  }

  void try_on_block(std::uint32_t place, const std::uint32_t* block, std::uint32_t n) {
    const std::uint32_t used = n == kPacketWidth ? 0xffffu : (1u << n) - 1;
    counts_.triangle_tests += n;
    for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes())
      meet_group(place, 1, block, used, g);
  }

  /// The stream's records, and the list of those that meet the scene's box: how many they are.
  std::uint32_t fill(std::uint32_t first, std::uint32_t count, std::uint32_t quarter) {
    Stream& s = stream_;
    RayPacket& p = packet_;
    alignas(64) float dx[kPacketWidth], dy[kPacketWidth], dz[kPacketWidth];
    std::uint32_t alive = 0;
    s.first = first;
    s.count = count;
    s.pad = 0;
    counts_.ray_box_tests += count;
    const std::uint32_t* order = job_.order + first;
    for (std::uint32_t base = 0; base < count; base += kPacketWidth) {
      const std::uint32_t n = std::min(kPacketWidth, count - base);
      for (std::uint32_t i = 0; i < kPacketWidth; ++i) {
        const std::uint32_t ahead = base + 4 * kPacketWidth + i;
        if (ahead < count) hwy::Prefetch(job_.rays + order[ahead]);
      }
      gather_rays(job_.rays, order + base, n, quarter, &p, dx, dy, dz);
      prepare_packet(tree_.bounds, dx, dy, dz, &p);
      std::uint32_t lanes = 0;
      if (HWY_LIKELY(p.bounded)) {
        lanes = clip_to_scene(tree_.bounds, &p);
        s.pad = p.pad > s.pad ? p.pad : s.pad;
      } else {
        for (std::uint32_t i = 0; i < n; ++i) unbounded_.push_back(base + i);
      }
      keep_packet(base);
      for (; lanes != 0; lanes &= lanes - 1)
        s.lists[alive++] = base + static_cast<std::uint32_t>(__builtin_ctz(lanes));
    }
    if (alive != 0) pad_list(0, alive);
    s.axis_x = p.axis_x;
    s.axis_y = p.axis_y;
    s.axis_z = p.axis_z;
    s.near_x = p.near_x;
    s.near_y = p.near_y;
    s.near_z = p.near_z;
    s.far_x = p.far_x;
    s.far_y = p.far_y;
    s.far_z = p.far_z;
    s.mirrored = p.mirrored;
    return alive;
  }

  /// The packet's lanes as the stream's records from `base` on.
  HWY_INLINE void keep_packet(std::uint32_t base) {
    Stream& s = stream_;
    const RayPacket& p = packet_;
    const RayInts di;
    const RV zero = hn::Zero(Rays());
    for (std::uint32_t g = 0; g < kPacketWidth; g += static_cast<std::uint32_t>(ray_lanes())) {
      StreamRay* rays = s.rays.data() + base + g;
      store4(load(p.ox + g), load(p.oy + g), load(p.oz + g), load(p.per_x + g), 0, rays);
      store4(load(p.per_y + g), load(p.s_near + g), load(p.s_far + g), load(p.along + g), 1, rays);
      StreamShear* shears = s.shears.data() + base + g;
      store4(load(p.shear_x + g), load(p.shear_y + g), load(p.shear_z + g), load(p.t_min + g), 0,
             shears);
      store4(load(p.t_limit + g), zero, zero, zero, 1, shears);
      hn::Store(hn::Load(di, p.index + g), di, s.index.data() + base + g);
    }
    std::fill_n(s.hits.data() + base, kPacketWidth, EngineHit{});
  }

  /// With every triangle.
  HWY_NOINLINE void test_unbounded() {
    const auto size = static_cast<std::uint32_t>(unbounded_.size());
    std::copy(unbounded_.begin(), unbounded_.end(), stream_.lists.begin());
    pad_list(0, size);
    for_each_leaf(tree_, [&](std::uint32_t quad, std::uint32_t n) {
      meet_leaf({quad, n, 0, size});
    });
    unbounded_.clear();
  }

  /// The children from far to near along the stream's axis.
  std::uint32_t sorted_children(const BvhNode& node, std::uint32_t* children) const {
    float near[kBvhWidth];
    const int z = stream_.axis_z;
    for (std::uint32_t c = 0; c < node.children; ++c) {
      const float at = stream_.mirrored ? -node.bound[z + 3][c] : node.bound[z][c];
      std::uint32_t place = c;
      for (; place > 0 && near[place - 1] < at; --place) {
        near[place] = near[place - 1];
        children[place] = children[place - 1];
      }
      near[place] = at;
      children[place] = c;
    }
    return node.children;
  }

  void open(const WaitingList& list) {
    using hn::Max, hn::Min, hn::Mul, hn::Sub;
    Stream& s = stream_;
    const BvhNode& node = tree_.nodes[list.first];
    std::uint32_t children[kBvhWidth];
    const std::uint32_t child_count = sorted_children(node, children);
    counts_.ray_box_tests += std::uint64_t{list.size} * child_count;
    const std::uint32_t room = (list.size + kPacketWidth + 15) / 16 * 16;
    const std::uint32_t bottom = (list.offset + list.size + 15) / 16 * 16;
    const std::size_t needed = bottom + std::size_t{room} * child_count + 2 * kPacketWidth;
    s.grow_lists(needed);
    // Bounds as the rays see them, grown by the pad: near and far on x, y, z.
    float box[kBvhWidth][6];
    std::uint32_t* out[kBvhWidth];
    const int rows[6] = {s.near_x, s.far_x, s.near_y, s.far_y, s.near_z, s.far_z};
    for (std::uint32_t k = 0; k < child_count; ++k) {
      for (int r = 0; r < 6; ++r)
        box[k][r] = node.bound[rows[r]][children[k]] + (rows[r] < 3 ? -s.pad : s.pad);
      if (s.mirrored) {
        box[k][4] = -box[k][4];
        box[k][5] = -box[k][5];
      }
      out[k] = s.lists.data() + bottom + room * k;
    }
    const std::uint32_t* numbers = s.lists.data() + list.offset;
    for (std::uint32_t base = 0; base < list.size; base += kPacketWidth) {
      const std::uint32_t n = std::min(kPacketWidth, list.size - base);
      const std::uint32_t* block = numbers + base;
      const std::uint32_t used = n == kPacketWidth ? 0xffffu : (1u << n) - 1;
      for (std::uint32_t i = n; i < std::min(2 * kPacketWidth, list.size - base); ++i)
        hwy::Prefetch(s.rays.data() + numbers[base + i]);
      for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
        RV ox, oy, z, per_x, per_y, s_near, s_far, unused;
        gather4(s.rays.data(), 0, block + g, ox, oy, z, per_x);
        gather4(s.rays.data(), 1, block + g, per_y, s_near, s_far, unused);
        const RV oz = s.mirrored ? hn::Neg(z) : z;
        const RM some = lanes_of(used, g);
        for (std::uint32_t k = 0; k < child_count; ++k) {
          const float* b = box[k];
          const RV x0 = Mul(Sub(set(b[0]), ox), per_x), x1 = Mul(Sub(set(b[1]), ox), per_x);
          const RV y0 = Mul(Sub(set(b[2]), oy), per_y), y1 = Mul(Sub(set(b[3]), oy), per_y);
          const RV near = Max(Max(x0, y0), Max(Sub(set(b[4]), oz), s_near));
          const RV far = Min(Min(x1, y1), Min(Sub(set(b[5]), oz), s_far));
          out[k] = append_set(block + g, hn::And(hn::Le(near, far), some), out[k]);
        }
      }
    }
    for (std::uint32_t k = 0; k < child_count; ++k) {
      const std::uint32_t offset = bottom + room * k;
      const auto size = static_cast<std::uint32_t>(out[k] - (s.lists.data() + offset));
      if (size == 0) continue;
      pad_list(offset, size);
      const std::uint32_t c = children[k];
      s.waiting.push_back({node.first[c], node.count[c], offset, size});
      prefetch_subtree(tree_, node.first[c], node.count[c]);
    }
  }

  /// Numbers beyond a list's end, so that its last block is read like the others.
  void pad_list(std::uint32_t offset, std::uint32_t size) {
    std::uint32_t* end = stream_.lists.data() + offset + size;
    const RayInts d;
    for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes())
      hn::StoreU(hn::Set(d, end[-1]), d, end + g);
  }

  void meet_leaf(const WaitingList& list) {
    Stream& s = stream_;
    counts_.triangle_tests += std::uint64_t{list.size} * list.count;
    const std::uint32_t* numbers = s.lists.data() + list.offset;
    for (std::uint32_t base = 0; base < list.size; base += kPacketWidth) {
      const std::uint32_t n = std::min(kPacketWidth, list.size - base);
      const std::uint32_t* block = numbers + base;
      const std::uint32_t used = n == kPacketWidth ? 0xffffu : (1u << n) - 1;
      for (std::uint32_t i = n; i < std::min(2 * kPacketWidth, list.size - base); ++i) {
        hwy::Prefetch(s.rays.data() + numbers[base + i]);
        hwy::Prefetch(s.shears.data() + numbers[base + i]);
      }
      for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes())
        meet_group(4 * list.first, list.count, block, used, g);
    }
  }

  /// Triangles from a place on with the lanes of a block from `g` on.
  HWY_INLINE void meet_group(std::uint32_t first, std::uint32_t count, const std::uint32_t* block,
                             std::uint32_t used, std::size_t g) {
    const Rays d;
    const Stream& s = stream_;
    RV ox, oy, oz, shear_x, shear_y, shear_z, t_min, t_limit, unused;
    gather4(s.rays.data(), 0, block + g, ox, oy, oz, unused);
    gather4(s.shears.data(), 0, block + g, shear_x, shear_y, shear_z, t_min);
    gather4(s.shears.data(), 1, block + g, t_limit, unused, unused, unused);
    for (std::uint32_t place = first; place < first + count; ++place) {
      const TriangleQuad& q = tree_.quads[place / 4];
      const std::uint32_t k = place % 4;
      const float* x = &q.vertex[0][s.axis_x][k];
      const float* y = &q.vertex[0][s.axis_y][k];
      const float* z = &q.vertex[0][s.axis_z][k];
      const auto moved = [&](int c) {
        return sheared(d, hn::Sub(set(x[12 * c]), ox), hn::Sub(set(y[12 * c]), oy),
                       hn::Sub(set(z[12 * c]), oz), shear_x, shear_y);
      };
      Tested<Rays> tested;
      if (test_lanes(d, moved(0), moved(1), moved(2), shear_z, t_min, t_limit, &tested))
        take_lanes(place, block, used, g, tested);
    }
  }

  RayPacket packet_;
  std::vector<std::uint32_t> places_;     ///< what pilots met, between two that are nothing
  std::vector<std::uint32_t> unbounded_;  ///< rays of packets that have no bounds
};
