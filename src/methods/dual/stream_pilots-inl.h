// Rays that go ahead of a stream without blocks. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.
//
// What stops a ray often stops those beside it (E. Haines, D. Greenberg, "The Light Buffer", 1986,
// keep the last occluder). Of sixteen rays of the list one goes ahead, and the triangles that
// stopped it and its neighbours' are tried on the sixteen; so part by part of the list, while that
// stops most. In blocks rays share so much of the tree that it saves nothing.

/// Fewer rays send no pilots: they would go alone.
inline constexpr std::uint32_t kFewestPiloted = 512;
/// As many go ahead before it is seen whether they are of use.
inline constexpr std::uint32_t kPilots = 64;

template <class Mode>
class StreamPilots : protected StreamBlocks<Mode> {
 protected:
  using StreamHits<Mode>::stream_, StreamHits<Mode>::counts_;
  using StreamLists<Mode>::meet_group, StreamLists<Mode>::pad_list, StreamBlocks<Mode>::walk;

  explicit StreamPilots(const TraceJob& job) : StreamBlocks<Mode>(job) {}

  /// Returns how many of the first `alive` rays of the list are left.
  std::uint32_t follow_pilots(std::uint32_t alive) {
    if (alive < kFewestPiloted) return alive;
    std::uint32_t left = 0, first = 0;
    while (first + kBundleWidth <= alive) {
      const std::uint32_t end = std::min(alive, first + kPilots * kBundleWidth);
      const std::uint32_t rest = follow_some(first, end, alive, left);
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

 private:
  /// Of rays [first, end) of the list; those that are left go to `left` and what follows. Returns
  /// the place after them.
  std::uint32_t follow_some(std::uint32_t first, std::uint32_t end, std::uint32_t alive,
                            std::uint32_t left) {
    RayStream& s = stream_;
    const std::uint32_t blocks = (end - first) / kBundleWidth, pilots = (alive + 31) / 16 * 16;
    s.grow_lists(pilots + blocks + std::size_t{2} * kBundleWidth);
    for (std::uint32_t b = 0; b < blocks; ++b)
      s.lists[pilots + b] = s.lists[first + b * kBundleWidth + kBundleWidth / 2];
    pad_list(pilots, blocks);
    walk(pilots, blocks, false);
    places_.assign(blocks + std::size_t{2}, kInvalidId);
    for (std::uint32_t b = 0; b < blocks; ++b) {
      StreamRay& pilot = s.rays[s.lists[first + b * kBundleWidth + kBundleWidth / 2]];
      places_[b + 1] = pilot.place;
      pilot.s_far = -std::numeric_limits<float>::infinity();  // done, hit or not
    }
    for (std::uint32_t b = 0; first + b * kBundleWidth < end; ++b) {
      std::uint32_t* const block = s.lists.data() + first + b * kBundleWidth;
      const std::uint32_t n = std::min(kBundleWidth, end - first - b * kBundleWidth);
      const std::uint32_t before = places_[b], middle = b < blocks ? places_[b + 1] : before;
      const std::uint32_t after = b < blocks ? places_[b + 2] : before;
      if (middle != kInvalidId) try_on(middle, block, n);
      if (before != kInvalidId && before != middle) try_on(before, block, n);
      if (after != kInvalidId && after != middle && after != before) try_on(after, block, n);
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t number = block[i];
        s.lists[left] = number;
        left += s.rays[number].s_far >= s.rays[number].s_near ? 1 : 0;
      }
    }
    return left;
  }

  void try_on(std::uint32_t place, const std::uint32_t* rays, std::uint32_t n) {
    const std::uint32_t used = n == kBundleWidth ? 0xffffu : (1u << n) - 1;
    counts_.triangle_tests += n;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) meet_group(place, 1, rays, used, g);
  }

  std::vector<std::uint32_t> places_;  ///< what pilots met, between two that are nothing
};
