// What a stream keeps of the hits it meets. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

/// Hits go back to rays that stand far apart.
inline constexpr std::uint32_t kWritesAhead = 24;
/// Fewer rays that stand apart are settled one by one.
inline constexpr int kFewestTogether = 3;

template <class Mode>
class StreamHits {
 protected:
  explicit StreamHits(const TraceJob& job)
      : job_(job),
        tree_(*job.scene.tree),
        in_blocks_(job.scene.bundle == Bundle::kStream),
        one_side_(job.scene.facing != Facing::kBoth && job.scene.flags != nullptr),
        own_(job.streams->take()),
        stream_(*own_) {
    stream_.rows.clear();
  }
  ~StreamHits() { job_.streams->give(std::move(own_)); }
  StreamHits(const StreamHits&) = delete;
  StreamHits& operator=(const StreamHits&) = delete;

  /// What lanes [g, g + ray_lanes()) of rays met: lane i is ray `number(i)`. `place`: of a triangle
  /// in the tree's quads, four each; so for all that take hits.
  template <class Number>
  HWY_INLINE void take_each(std::uint32_t place, std::uint32_t hit, std::uint32_t unsettled,
                            const Tested<Rays>& tested, const Number& number) {
    const Rays d;
    alignas(64) float low[kBundleWidth], high[kBundleWidth];
    hn::Store(tested.low, d, low);
    hn::Store(tested.high, d, high);
    const std::uint32_t front = bits_of(d, hn::Gt(tested.det, hn::Zero(d)));
    for (; hit != 0; hit &= hit - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(hit));
      take(number(i), place, {low[i], high[i]}, (front >> i & 1) != 0);
    }
    settle_lanes(place, unsettled, number);
  }

  HWY_NOINLINE void take_lanes(std::uint32_t place, const std::uint32_t* block, std::uint32_t used,
                               std::size_t g, const Tested<Rays>& tested) {
    const std::uint32_t hit = bits_of(Rays(), tested.hit) & used >> g;
    std::uint32_t unsettled = bits_of(Rays(), tested.unsettled) & used >> g;
    if ((hit | unsettled) == 0) return;
    if (__builtin_popcount(unsettled) >= kFewestTogether) unsettled &= ~beyond(place, block + g);
    take_each(place, hit, unsettled, tested, [&](std::uint32_t i) { return block[g + i]; });
  }

  [[nodiscard]] HWY_INLINE std::uint32_t beyond(std::uint32_t place,
                                                const std::uint32_t* numbers) const {
    const Rays d;
    alignas(64) float column[8][kBundleWidth];
    RV v[8];
    for (int part = 0; part < 2; ++part)
      gather4(stream_.rays.data(), part, numbers, v[4 * part], v[4 * part + 1], v[4 * part + 2],
              v[4 * part + 3]);
    for (int i = 0; i < 8; ++i) hn::Store(v[i], d, column[i]);
    return lanes_beyond_plane(
        tree_, stream_, place,
        {column[0], column[1], column[2], column[4], column[5], column[6], column[7], column[3]});
  }

  /// The same for rays of a block, all at once.
  HWY_NOINLINE void take_in_block(std::uint32_t place, BlockRays rays, std::size_t g,
                                  const Tested<Rays>& tested) {
    const Rays d;
    const std::uint32_t used = std::uint32_t{rays.rays} >> g;
    const std::uint32_t hit = bits_of(d, tested.hit) & used;
    std::uint32_t unsettled = bits_of(d, tested.unsettled) & used;
    if (unsettled != 0)
      unsettled &=
          ~lanes_beyond_plane(tree_, stream_, place, columns_from(stream_.blocks[rays.block], g));
    if ((hit | unsettled) == 0) return;
    const auto first = static_cast<std::uint32_t>(rays.block * kBundleWidth + g);
    const auto number = [first](std::uint32_t i) { return first + i; };
    if (Mode::kAll || one_side_) return take_each(place, hit, unsettled, tested, number);
    StreamBlock& b = stream_.blocks[rays.block];
    const RayInts di;
    const RV limit = load(b.t_limit + g), far = load(b.s_far + g);
    const auto best = hn::Load(di, b.place + g);
    RV high, end;
    RM nearer = lanes_of(hit, 0);
    hn::Vec<RayInts> met = hn::Set(di, place);
    std::uint32_t rest = unsettled;
    if constexpr (Mode::kAny) {
      // The least of a leaf's, whatever order a SIMD target finds them in.
      met = hn::Min(best, met);
      high = set(-1);
      end = set(-std::numeric_limits<float>::infinity());
    } else {
      const RV low = load(b.t_low + g);
      nearer = hn::And(nearer, hn::Lt(tested.high, low));
      rest |= hit & ~bits_of(d, nearer);
      high = tested.high;
      end = hn::Min(past(high, load(b.along + g), stream_.pad), far);
      hn::Store(hn::IfThenElse(nearer, tested.low, low), d, b.t_low + g);
    }
    hn::Store(hn::IfThenElse(nearer, high, limit), d, b.t_limit + g);
    hn::Store(hn::IfThenElse(nearer, end, far), d, b.s_far + g);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, nearer), met, best), di, b.place + g);
    for (std::uint32_t turn = bits_of(d, nearer) & stream_.recorded[rays.block] >> g; turn != 0;
         turn &= turn - 1)
      tell_record(number(static_cast<std::uint32_t>(__builtin_ctz(turn))));
    settle_lanes(place, rest, number);
  }

  template <class Number>
  HWY_INLINE void settle_lanes(std::uint32_t place, std::uint32_t rest, const Number& number) {
    for (; rest != 0; rest &= rest - 1)
      settle(number(static_cast<std::uint32_t>(__builtin_ctz(rest))), place);
  }

  /// A ray and a triangle that stage 1 cannot tell of, or whose hit it cannot tell from the ray's
  /// best.
  HWY_NOINLINE void settle(std::uint32_t n, std::uint32_t place) {
    const PlacedCorners p(tree_, place, stream_);
    if (Plane(p.a, p.b, p.c).surely_beyond(sloped(n), p.a)) return;
    const Ray& ray = job_.rays[stream_.index[n]];
    const Limits r = limits_of(n);
    TriangleHit hit;
    if (!settle_at(tree_, ray, place, *r.best.high, &hit) || !is_shown(place, hit.front)) return;
    if constexpr (Mode::kAll || Mode::kAny) {
      keep(n, place, r);
    } else {
      if (r.best.take_settled(tree_, ray, place, hit.t)) shorten(n, r);
    }
  }

  /// A hit within the ray's limits.
  void take(std::uint32_t n, std::uint32_t place, Interval t, bool front) {
    if (!is_shown(place, front)) return;
    const Limits r = limits_of(n);
    if constexpr (Mode::kAll || Mode::kAny) {
      keep(n, place, r);
    } else if (t.high < *r.best.low) {
      *r.best.low = t.low;
      *r.best.high = t.high;
      *r.best.place = place;
      shorten(n, r);
    } else if (t.low <= *r.best.high) {
      settle(n, place);
    }
  }

  HWY_INLINE void prefetch_ray(std::uint32_t n) const { hwy::Prefetch(stream_.rays.data() + n); }

  void write_back() {
    if constexpr (Mode::kAny) write_back_any();
    if constexpr (!Mode::kAny && !Mode::kAll) write_back_closest();
  }

  const TraceJob& job_;
  const ObjectTree& tree_;
  const bool in_blocks_;  ///< neighbours are expected to stay together for a while
  const bool one_side_;   ///< hits of some triangles' other side do not count
  std::unique_ptr<RayStream> own_;
  RayStream& stream_;
  DualCounts counts_;

 private:
  /// Where a ray keeps what it looks for.
  struct Limits {
    BestHit best;
    float* s_far;
    float along;
  };
  [[nodiscard]] HWY_INLINE Limits limits_of(std::uint32_t n) const {
    if (in_blocks_) {
      StreamBlock& b = block_of(n);
      const std::uint32_t i = n % kBundleWidth;
      return {{&b.t_low[i], &b.t_limit[i], &b.place[i]}, &b.s_far[i], b.along[i]};
    }
    StreamRay& r = stream_.rays[n];
    return {{&r.t_low, &r.t_limit, &r.place}, &r.s_far, r.along};
  }
  [[nodiscard]] HWY_INLINE SlopedRay sloped(std::uint32_t n) const {
    const bool has_record =
        !in_blocks_ || (stream_.recorded[n / kBundleWidth] >> n % kBundleWidth & 1) != 0;
    const StreamRay r = has_record ? stream_.rays[n] : block_of(n).ray(n % kBundleWidth);
    return {{r.ox, r.oy, r.oz}, r.shear_x, r.shear_y, r.shear_z, r.t_min, r.t_limit};
  }
  [[nodiscard]] HWY_INLINE StreamBlock& block_of(std::uint32_t n) const {
    return stream_.blocks[n / kBundleWidth];
  }

  [[nodiscard]] HWY_INLINE bool is_shown(std::uint32_t place, bool front) const {
    return !one_side_ || shows(job_.scene.facing, job_.scene.flags[id_at(tree_, place)], front);
  }

  /// A ray's record learns how far it looks.
  HWY_INLINE void tell_record(std::uint32_t n) {
    const StreamBlock& b = block_of(n);
    stream_.rays[n].t_limit = b.t_limit[n % kBundleWidth];
    stream_.rays[n].s_far = b.s_far[n % kBundleWidth];
  }

  /// The ray looks no farther than its best hit.
  HWY_INLINE void shorten(std::uint32_t n, const Limits& r) {
    *r.s_far = std::min(*r.s_far, raysheaf::past(*r.best.high, r.along, stream_.pad));
    if (in_blocks_) tell_record(n);
  }

  /// A hit where it matters only that there is one.
  HWY_INLINE void keep(std::uint32_t n, std::uint32_t place, const Limits& r) {
    if constexpr (Mode::kAll) {
      if (job_.hit_counts != nullptr)
        ++job_.hit_counts[stream_.index[n]];
      else
        stream_.rows.push_back({stream_.first + n, {0, 0, 0, place}});
    } else {
      // The least of a leaf's, whatever order a SIMD target finds them in.
      *r.best.place = std::min(*r.best.place, place);
      *r.best.high = -1;
      *r.s_far = -std::numeric_limits<float>::infinity();
      if (in_blocks_) tell_record(n);
    }
  }

  void write_back_any() {
    const RayStream& s = stream_;
    for (std::uint32_t i = 0; i < s.count; ++i) {
      const std::uint32_t place =
          in_blocks_ ? s.blocks[i / kBundleWidth].place[i % kBundleWidth] : s.rays[i].place;
      job_.occluded[s.index[i]] = place != kInvalidId ? 1 : 0;
    }
  }

  /// The values of sixteen hits while the corners of the next sixteen are on their way.
  void write_back_closest() {
    const RayStream& s = stream_;
    alignas(64) IndexedHit hits[kBundleWidth];
    if (s.count != 0) fill_values(0);
    for (std::uint32_t base = 0; base < s.count; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, s.count - base), next = base + kBundleWidth;
      if (next < s.count) fill_values(next);
      values_[base / kBundleWidth % 2].store(tree_, hits);
      for (std::uint32_t i = 0; i < n; ++i) job_.hits[s.index[base + i]] = hits[i];
    }
  }

  HWY_INLINE void fill_values(std::uint32_t base) {
    const RayStream& s = stream_;
    const std::uint32_t ahead = std::min(base + kWritesAhead, s.count);
    for (std::uint32_t i = base + kWritesAhead - kBundleWidth; i < ahead; ++i)
      __builtin_prefetch(job_.hits + s.index[i], 1);
    alignas(64) std::uint32_t places[kBundleWidth];
    if (in_blocks_) {
      std::copy_n(s.blocks[base / kBundleWidth].place, kBundleWidth, places);
    } else {
      for (std::uint32_t i = 0; i < kBundleWidth; ++i) places[i] = s.rays[base + i].place;
    }
    values_[base / kBundleWidth % 2].fill(tree_, job_.rays, s.index.data() + base, places);
  }

  HitValues values_[2];
};
