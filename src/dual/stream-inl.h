// Streams of rays through the tree. Included by dual/trace_simd.cpp, inside its namespace.

/// Fewer rays send no pilots: they would go alone.
inline constexpr std::uint32_t kFewestPiloted = 512;
/// As many go ahead before it is seen whether they are of use.
inline constexpr std::uint32_t kPilots = 64;

template <class Mode>
class StreamWalk : StreamBlocks<Mode> {
 public:
  explicit StreamWalk(const TraceJob& job) : StreamBlocks<Mode>(job) {}

  /// Rays [first, first + count) of the order, of one quarter.
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

  /// Hands over what was counted and found.
  void finish(const TraceTask& task) {
    if constexpr (Mode::kAll) hand_over_rows(job_, task, stream_.rows);
    const std::lock_guard<std::mutex> lock(*job_.mutex);
    if (job_.counts != nullptr) job_.counts->add(counts_);
  }

 private:
  using StreamHits<Mode>::job_, StreamHits<Mode>::tree_, StreamHits<Mode>::stream_;
  using StreamHits<Mode>::in_blocks_, StreamHits<Mode>::counts_;
  using StreamHits<Mode>::end_ray, StreamHits<Mode>::write_back;
  using StreamLists<Mode>::meet_leaf, StreamLists<Mode>::meet_group, StreamLists<Mode>::pad_list;
  using StreamBlocks<Mode>::walk;

  /// What stops a ray often stops those beside it (E. Haines, D. Greenberg, "The Light Buffer",
  /// 1986, keep the last occluder). Of each block of the list one ray goes ahead, and the triangles
  /// that stopped it and its neighbours' are tried on the block; so part by part of the list, while
  /// that stops most. Returns how many of the first `alive` of the list are left.
  std::uint32_t follow_pilots(std::uint32_t alive) {
    std::uint32_t left = 0, first = 0;
    while (first + kPacketWidth <= alive) {
      const std::uint32_t end = std::min(alive, first + kPilots * kPacketWidth);
      const std::uint32_t rest = follow_pilots(first, end, alive, left);
      const bool worth = 2 * (rest - left) < end - first;
      left = rest;
      first = end;
      if (!worth) break;
    }
    std::uint32_t* const numbers = stream_.lists.data();
    std::copy(numbers + first, numbers + alive, numbers + left);
    left += alive - first;
    if (left != 0) pad_list(0, left);
    return left;
  }

  /// Of rays [first, end) of the list; those that are left go to `left` and what follows. Returns
  /// the place after them.
  std::uint32_t follow_pilots(std::uint32_t first, std::uint32_t end, std::uint32_t alive,
                              std::uint32_t left) {
    Stream& s = stream_;
    const std::uint32_t blocks = (end - first) / kPacketWidth, pilots = (alive + 31) / 16 * 16;
    s.grow_lists(pilots + blocks + std::size_t{2} * kPacketWidth);
    for (std::uint32_t b = 0; b < blocks; ++b)
      s.lists[pilots + b] = s.lists[first + b * kPacketWidth + kPacketWidth / 2];
    pad_list(pilots, blocks);
    walk(pilots, blocks);
    places_.assign(blocks + std::size_t{2}, kInvalidId);
    for (std::uint32_t b = 0; b < blocks; ++b) {
      const std::uint32_t pilot = s.lists[first + b * kPacketWidth + kPacketWidth / 2];
      places_[b + 1] = s.rays[pilot].triangle;
      end_ray(pilot, -std::numeric_limits<float>::infinity());  // done, hit or not
    }
    for (std::uint32_t b = 0; first + b * kPacketWidth < end; ++b) {
      std::uint32_t* const block = s.lists.data() + first + b * kPacketWidth;
      const std::uint32_t n = std::min(kPacketWidth, end - first - b * kPacketWidth);
      const std::uint32_t before = places_[b], middle = b < blocks ? places_[b + 1] : before;
      const std::uint32_t after = b < blocks ? places_[b + 2] : before;
      if (middle != kInvalidId) try_on_block(middle, block, n);
      if (before != kInvalidId && before != middle) try_on_block(before, block, n);
      if (after != kInvalidId && after != middle && after != before) try_on_block(after, block, n);
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t number = block[i];
        s.lists[left] = number;
        left += s.rays[number].s_far >= s.rays[number].s_near ? 1 : 0;
      }
    }
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
    s.fit(count);
    static_cast<QuarterAxes&>(s) = static_cast<QuarterAxes&>(packet_) = QuarterAxes(quarter);
    std::uint32_t* end = s.lists.data();
    s.first = first;
    s.count = count;
    s.pad = 0;
    counts_.ray_box_tests += count;
    const std::uint32_t* order = job_.order + first;
    for (std::uint32_t base = 0; base < count; base += kPacketWidth) {
      const std::uint32_t n = std::min(kPacketWidth, count - base);
      const std::uint32_t ahead = base + 8 * kPacketWidth;
      if (ahead + kPacketWidth <= count &&
          order[ahead + kPacketWidth - 1] - order[ahead] != kPacketWidth - 1) {
        for (std::uint32_t i = 0; i < kPacketWidth; ++i)
          hwy::Prefetch(job_.rays + order[ahead + i]);
      }
      copy_numbers(order + base, n, s.index.data() + base);
      const PreparedLanes prepared =
          prepare_lanes(job_.rays, s.index.data() + base, n, tree_.bounds, s,
                        [&](std::size_t g, const RayLanes& r, const SlabLanes& slabs)
                            HWY_ATTR { keep_lanes(base, g, r, slabs); });
      if (HWY_LIKELY(prepared.bounded)) {
        s.pad = std::max(s.pad, prepared.pad);
      } else {
        for (std::uint32_t i = 0; i < n; ++i) unbounded_.push_back(base + i);
      }
      packet_.pad = prepared.pad;
      if (in_blocks_ && prepared.lanes != 0)
        s.beams[base / kPacketWidth] = make_beam(prepared.lanes, &packet_);
      end = append_lanes(base, prepared.lanes, end);
    }
    const auto alive = static_cast<std::uint32_t>(end - s.lists.data());
    if (alive != 0) pad_list(0, alive);
    return alive;
  }

  /// As the stream's records from `base` on, and, if there are blocks, in its block and where
  /// `make_beam` reads them.
  HWY_INLINE void keep_lanes(std::uint32_t base, std::size_t g, const RayLanes& r,
                             const SlabLanes& slabs) {
    Stream& s = stream_;
    const Rays d;
    StreamRay* const rays = s.rays.data() + base + g;
    const RV none = hn::BitCast(d, hn::Set(RayInts(), kInvalidId));
    store4(r.ox, r.oy, r.oz, r.t_limit, 0, rays);
    store4(slabs.shear_x, slabs.shear_y, slabs.shear_z, r.t_min, 1, rays);
    store4(slabs.per_x, slabs.per_y, slabs.s_near, slabs.s_far, 2, rays);
    store4(slabs.along, hn::Zero(d), hn::Zero(d), none, 3, rays);
    if (!in_blocks_) return;
    const auto put = [&](RV v, float* to) HWY_ATTR { hn::Store(v, d, to + g); };
    StreamBlock& b = s.blocks[base / kPacketWidth];
    put(r.ox, b.ox), put(r.oy, b.oy), put(r.oz, b.oz);
    put(slabs.per_x, b.per_x), put(slabs.per_y, b.per_y);
    put(slabs.s_near, b.s_near), put(slabs.s_far, b.s_far);
    RayPacket& p = packet_;
    put(r.ox, p.ox), put(r.oy, p.oy), put(r.oz, p.oz);
    put(slabs.shear_x, p.shear_x), put(slabs.shear_y, p.shear_y);
    put(slabs.s_near, p.s_near), put(slabs.s_far, p.s_far);
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

  RayPacket packet_;
  std::vector<std::uint32_t> places_;     ///< what pilots met, between two that are nothing
  std::vector<std::uint32_t> unbounded_;  ///< rays of packets that have no bounds
};
