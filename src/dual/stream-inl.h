// Streams of rays through the tree. Included by dual/trace_simd.cpp, inside its namespace.

/// Fewer rays send no pilots: they would go alone.
inline constexpr std::uint32_t kFewestPiloted = 512;
/// As many go ahead before it is seen whether they are of use.
inline constexpr std::uint32_t kPilots = 64;

template <class Mode>
class StreamWalk : StreamBlocks<Mode> {
 public:
  explicit StreamWalk(const TraceJob& job) : StreamBlocks<Mode>(job) {}

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
      places_[b + 1] = s.hits[pilot].triangle;
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
    RayPacket& p = packet_;
    alignas(64) float dx[kPacketWidth], dy[kPacketWidth], dz[kPacketWidth];
    std::uint32_t* end = s.lists.data();
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
      keep_block(lanes, base / kPacketWidth);
      end = append_lanes(base, lanes, end);
    }
    const auto alive = static_cast<std::uint32_t>(end - s.lists.data());
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

  /// The packet's lanes as a block of the stream's.
  HWY_INLINE void keep_block(std::uint32_t lanes, std::uint32_t number) {
    RayPacket& p = packet_;
    StreamBlock& b = stream_.blocks[number];
    const Rays d;
    for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
      hn::Store(load(p.ox + g), d, b.ox + g);
      hn::Store(load(p.oy + g), d, b.oy + g);
      hn::Store(load(p.oz + g), d, b.oz + g);
      hn::Store(load(p.per_x + g), d, b.per_x + g);
      hn::Store(load(p.per_y + g), d, b.per_y + g);
      hn::Store(load(p.s_near + g), d, b.s_near + g);
      hn::Store(load(p.s_far + g), d, b.s_far + g);
    }
    if (lanes != 0) b.beam = make_beam(lanes, &p);
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
