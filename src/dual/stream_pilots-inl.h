// Rays that go ahead of a stream. Included once a SIMD target by dual/trace_simd.cpp, inside its
// namespace.
//
// What stops a ray often stops those beside it (E. Haines, D. Greenberg, "The Light Buffer", 1986,
// keep the last occluder). Of sixteen rays of the list, or a block's, one goes ahead, and the
// triangles that stopped it and its neighbours' are tried on the sixteen; so part by part of the
// list, while that stops most.

/// Of fewer sixteens none send pilots: they would go alone.
inline constexpr std::uint32_t kFewestPiloted = 32;
/// As many go ahead before it is seen whether they are of use.
inline constexpr std::uint32_t kPilots = 64;

template <class Mode>
class StreamPilots : protected StreamBlocks<Mode> {
 protected:
  using StreamHits<Mode>::stream_, StreamHits<Mode>::in_blocks_, StreamHits<Mode>::counts_;
  using StreamLists<Mode>::meet_group, StreamLists<Mode>::pad_list;
  using StreamBlocks<Mode>::leave_block, StreamBlocks<Mode>::meet_block, StreamBlocks<Mode>::walk;

  explicit StreamPilots(const TraceJob& job)
      : StreamBlocks<Mode>(job), unit_(in_blocks_ ? 1 : kPacketWidth) {}

  /// How many of the first `alive` entries of the list are left.
  std::uint32_t follow_pilots(std::uint32_t alive) {
    if (alive < kFewestPiloted * unit_) return alive;
    std::uint32_t left = 0, first = 0;
    for (bool worth = true; worth && first < alive;) {
      const std::uint32_t end = std::min(alive, first + kPilots * unit_);
      const std::uint32_t before = rays_in(first, end), from = left;
      send_pilots(first, end, alive);
      for (std::uint32_t n = first; n < end; n += unit_) follow(n, end, (n - first) / unit_, &left);
      worth = 2 * rays_in(from, left) < before;
      first = end;
    }
    std::uint32_t* const list = stream_.lists.data();
    std::copy(list + first, list + alive, list + left);
    left += alive - first;
    if (left != 0) pad_list(0, left);
    return left;
  }

 private:
  [[nodiscard]] BlockRays block_at(std::uint32_t n) const {
    return std::bit_cast<BlockRays>(stream_.lists[n]);
  }

  /// Of entries [first, end).
  [[nodiscard]] std::uint32_t rays_in(std::uint32_t first, std::uint32_t end) const {
    if (!in_blocks_) return end - first;
    std::uint32_t rays = 0;
    for (; first < end; ++first)
      rays += static_cast<std::uint32_t>(__builtin_popcount(block_at(first).rays));
    return rays;
  }

  /// The ray in the middle of the entries from n on, or one beside it.
  [[nodiscard]] std::uint32_t pilot_at(std::uint32_t n, std::uint32_t end) const {
    constexpr std::uint32_t kMiddle = kPacketWidth / 2;
    if (!in_blocks_) return stream_.lists[std::min(n + kMiddle, end - 1)];
    const BlockRays block = block_at(n);
    const std::uint32_t later = std::uint32_t{block.rays} >> kMiddle;
    return block.block * kPacketWidth +
           static_cast<std::uint32_t>(later != 0 ? kMiddle + __builtin_ctz(later)
                                                 : 31 - __builtin_clz(block.rays));
  }

  /// Those of entries [first, end) of `alive`; `places_` takes what they meet.
  void send_pilots(std::uint32_t first, std::uint32_t end, std::uint32_t alive) {
    Stream& s = stream_;
    const std::uint32_t offset = (alive + 31) / 16 * 16;
    s.grow_lists(offset + (end - first) + std::size_t{2} * kPacketWidth);
    std::uint32_t count = 0;
    for (std::uint32_t n = first; n < end; n += unit_) {
      const std::uint32_t pilot = pilot_at(n, end);
      if (in_blocks_) leave_block(pilot / kPacketWidth, 1u << pilot % kPacketWidth);
      s.lists[offset + count++] = pilot;
    }
    pad_list(offset, count);
    walk(offset, count, false);
    places_.assign(1, kInvalidId);
    for (std::uint32_t n = first; n < end; n += unit_)
      places_.push_back(finish_pilot(pilot_at(n, end)));
    places_.push_back(kInvalidId);
  }

  /// It is done, hit or not. Returns what it met.
  std::uint32_t finish_pilot(std::uint32_t n) {
    StreamBlock& block = stream_.blocks[in_blocks_ ? n / kPacketWidth : 0];
    StreamRay& ray = stream_.rays[n];
    (in_blocks_ ? block.s_far[n % kPacketWidth] : ray.s_far) =
        -std::numeric_limits<float>::infinity();
    return in_blocks_ ? block.triangle[n % kPacketWidth] : ray.triangle;
  }

  /// What pilot number `pilot`, and those beside it, met is tried on the entries from n on; those
  /// that are left go to the list from `left` on.
  void follow(std::uint32_t n, std::uint32_t end, std::uint32_t pilot, std::uint32_t* left) {
    const std::uint32_t before = places_[pilot], middle = places_[pilot + 1];
    const std::uint32_t after = places_[pilot + 2];
    const auto try_on = [&](std::uint32_t place) HWY_ATTR {
      if (place == kInvalidId) return;
      in_blocks_ ? try_on_block(place, block_at(n)) : try_on_rays(place, n, end);
    };
    try_on(middle);
    if (before != middle) try_on(before);
    if (after != middle && after != before) try_on(after);
    in_blocks_ ? keep_block(block_at(n), left) : keep_rays(n, end, left);
  }

  HWY_INLINE void try_on_block(std::uint32_t place, BlockRays block) {
    counts_.triangle_tests += static_cast<std::uint32_t>(__builtin_popcount(block.rays));
    meet_block(place, 1, block);
  }

  HWY_INLINE void try_on_rays(std::uint32_t place, std::uint32_t n, std::uint32_t end) {
    const std::uint32_t count = std::min(kPacketWidth, end - n), used = (1u << count) - 1;
    counts_.triangle_tests += count;
    for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes())
      meet_group(place, 1, stream_.lists.data() + n, used, g);
  }

  void keep_block(BlockRays block, std::uint32_t* left) {
    const StreamBlock& b = stream_.blocks[block.block];
    std::uint32_t looking = 0;
    for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes())
      looking |= bits_of(Rays(), hn::Ge(load(b.s_far + g), load(b.s_near + g))) << g;
    looking &= block.rays;
    stream_.lists[*left] = word_of(block.block, looking);
    *left += looking != 0 ? 1 : 0;
  }

  void keep_rays(std::uint32_t n, std::uint32_t end, std::uint32_t* left) {
    for (end = std::min(end, n + kPacketWidth); n < end; ++n) {
      const std::uint32_t number = stream_.lists[n];
      stream_.lists[*left] = number;
      *left += stream_.rays[number].s_far >= stream_.rays[number].s_near ? 1 : 0;
    }
  }

  const std::uint32_t unit_;           ///< entries of sixteen rays
  std::vector<std::uint32_t> places_;  ///< what pilots met, between two that are nothing
};
