// Streams of rays through the tree. Included by methods/dual/trace_simd.cpp, inside its namespace.

template <class Mode>
class StreamWalk : StreamPilots<Mode> {
 public:
  explicit StreamWalk(const TraceJob& job) : StreamPilots<Mode>(job) {}

  /// Rays [first, first + count) of the order, of one quarter.
  void run(std::uint32_t first, std::uint32_t count, std::uint32_t quarter) {
    const DualCounts before = counts_;
    std::uint32_t alive = fill(first, count, quarter);
    if constexpr (Mode::kAny) {
      if (!in_blocks_) alive = follow_pilots(alive);
    }
    walk(0, alive, in_blocks_);
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
  using StreamHits<Mode>::write_back;
  using StreamLists<Mode>::pad_list, StreamPilots<Mode>::follow_pilots;
  using StreamLists<Mode>::meet_leaf, StreamBlocks<Mode>::meet_leaf_in_blocks;
  using StreamBlocks<Mode>::walk;

  /// The stream's rays, and the list of those that meet the scene's box, or of their blocks: how
  /// many they are.
  std::uint32_t fill(std::uint32_t first, std::uint32_t count, std::uint32_t quarter) {
    RayStream& s = stream_;
    s.fit(count);
    static_cast<QuarterAxes&>(s) = QuarterAxes(quarter);
    std::uint32_t* end = s.lists.data();
    s.first = first;
    s.count = count;
    s.pad = 0;
    counts_.ray_box_tests += count;
    const std::uint32_t* order = job_.order + first;
    for (std::uint32_t base = 0; base < count; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, count - base);
      const std::uint32_t ahead = base + 8 * kBundleWidth;
      if (ahead + kBundleWidth <= count &&
          order[ahead + kBundleWidth - 1] - order[ahead] != kBundleWidth - 1) {
        for (std::uint32_t i = 0; i < kBundleWidth; ++i)
          hwy::Prefetch(job_.rays + order[ahead + i]);
      }
      copy_numbers(order + base, n, s.index.data() + base);
      const PreparedLanes prepared =
          prepare_lanes(job_.rays, s.index.data() + base, n, tree_.bounds, s,
                        [&](std::size_t g, const RayLanes& r, const SlabLanes& slabs)
                            HWY_ATTR { keep_lanes(base, g, r, slabs); });
      const std::uint32_t block = base / kBundleWidth;
      if (HWY_LIKELY(prepared.bounded)) {
        s.pad = std::max(s.pad, prepared.pad);
      } else if (in_blocks_) {
        unbounded_.push_back(word_of(block, (1u << n) - 1));
      } else {
        for (std::uint32_t i = 0; i < n; ++i) unbounded_.push_back(base + i);
      }
      if (in_blocks_) {
        s.recorded[block] = 0;
        if (prepared.lanes == 0) continue;
        alignas(64) float zetas[kBundleWidth];
        s.beams[block] =
            make_beam(prepared.lanes, s.blocks[block], s.mirrored, prepared.pad, zetas);
        *end++ = word_of(block, prepared.lanes);
      } else {
        end = append_lanes(base, prepared.lanes, end);
      }
    }
    const auto alive = static_cast<std::uint32_t>(end - s.lists.data());
    if (alive != 0) pad_list(0, alive);
    return alive;
  }

  /// As rays `base` + `g` and those after it.
  HWY_INLINE void keep_lanes(std::uint32_t base, std::size_t g, const RayLanes& r,
                             const SlabLanes& slabs) {
    RayStream& s = stream_;
    const Rays d;
    const RayInts di;
    if (!in_blocks_) {
      StreamRay* const rays = s.rays.data() + base + g;
      const RV none = hn::BitCast(d, hn::Set(di, kInvalidId));
      store4(r.ox, r.oy, r.oz, r.t_limit, 0, rays);
      store4(slabs.shear_x, slabs.shear_y, slabs.shear_z, r.t_min, 1, rays);
      store4(slabs.per_x, slabs.per_y, slabs.s_near, slabs.s_far, 2, rays);
      store4(slabs.along, r.t_limit, none, none, 3, rays);
      return;
    }
    StreamBlock& b = s.blocks[base / kBundleWidth];
    const auto put = [&](RV v, float* to) HWY_ATTR { hn::Store(v, d, to + g); };
    put(r.ox, b.ox), put(r.oy, b.oy), put(r.oz, b.oz), put(r.t_limit, b.t_limit);
    put(slabs.shear_x, b.shear_x), put(slabs.shear_y, b.shear_y), put(slabs.shear_z, b.shear_z);
    put(r.t_min, b.t_min);
    put(slabs.per_x, b.per_x), put(slabs.per_y, b.per_y);
    put(slabs.s_near, b.s_near), put(slabs.s_far, b.s_far);
    put(slabs.along, b.along), put(r.t_limit, b.t_low);
    hn::Store(hn::Set(di, kInvalidId), di, b.place + g);
  }

  /// With every triangle.
  HWY_NOINLINE void test_unbounded() {
    const auto size = static_cast<std::uint32_t>(unbounded_.size());
    std::copy(unbounded_.begin(), unbounded_.end(), stream_.lists.begin());
    pad_list(0, size);
    for_each_leaf(tree_, [&](std::uint32_t quad, std::uint32_t n) {
      job_.executor->check();
      const WaitingList list{quad, n, 0, size, in_blocks_};
      in_blocks_ ? meet_leaf_in_blocks(list) : meet_leaf(list);
    });
    unbounded_.clear();
  }

  std::vector<std::uint32_t> unbounded_;  ///< of bundles that have no bounds: rays, or blocks
};
