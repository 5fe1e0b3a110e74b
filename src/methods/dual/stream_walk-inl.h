// Traces streams of rays through the tree (methods/dual/ray_stream.h). Included once for each SIMD
// target by methods/dual/trace_simd.cpp, inside its namespace.
//
//   StreamWalk      fills a stream, traces it through the tree, stores its hits
//     StreamBundles    sixteen neighbours at a time, while most of them stay together
//     StreamLists     lists of rays from node to node
//     StreamSingles   rays that share a subtree with few others, one by one
//     StreamHits      the best hit of each ray so far

/// The state of a `StreamWalk`.
struct StreamState {
  StreamState(const StreamJob& given, const Subtrees& all) : job(given), subtrees(all) {
    stream.rows.clear();
  }

  const StreamJob& job;
  const ObjectTree& tree{*job.scene.tree};
  const Subtrees subtrees;
  /// Neighbours are expected to stay together for a while.
  const bool in_bundles = job.scene.bundle == Bundle::kStream;
  const Borrowed<RayStream> own{*job.streams};
  RayStream& stream{*own};
  DualCounts counts;
};

/// The view of this state that each part of a `StreamWalk` has.
class StreamPart {
 protected:
  explicit StreamPart(StreamState& s)
      : job_(s.job),
        tree_(s.tree),
        subtrees_(s.subtrees),
        in_bundles_(s.in_bundles),
        stream_(s.stream),
        counts_(s.counts) {}

  const StreamJob& job_;
  const ObjectTree& tree_;
  const Subtrees& subtrees_;
  const bool in_bundles_;
  RayStream& stream_;
  DualCounts& counts_;
};

/// Prefetch distance: results are written to scattered rays.
inline constexpr std::uint32_t kWritesAhead = 24;
/// If fewer lanes than this are set, they are settled one by one.
inline constexpr int kFewestTogether = 3;

/// Takes the hits of rays, one at a time, exactly where stage 1 leaves something open. `Self` holds
/// the rays and has, for its ray n: `limits_of(n)`; `number_of(n)`, the caller's; `axes_of(n)`;
/// `sloped(n)`, its line; `ends(n)`, called where its limits have changed; with Mode::kAll
/// `store(n, place)`, which receives its hits.
template <class Mode, class Self>
class RayHits {
 public:
  explicit RayHits(const TraceJob& job)
      : ray_job_(job), triangles_(*job.scene.tree), hits_are_chosen_(chooses_hits(job.scene)) {}

  /// Decides the test of a ray and a triangle that stage 1 cannot decide, or whose hit it cannot
  /// distinguish from the ray's best.
  HWY_NOINLINE void settle(std::uint32_t n, std::uint32_t place) {
    if constexpr (!Mode::kAll && !Mode::kAny) {
      if (take_copy(n, place)) return;
    }
    const PlacedCorners p(triangles_, place, self().axes_of(n));
    if (Plane(p.a, p.b, p.c).surely_beyond(self().sloped(n), p.a)) return;
    const Ray& ray = ray_job_.rays[self().number_of(n)];
    const RayLimits r = self().limits_of(n);
    TriangleHit hit;
    if (!settle_at(triangles_, ray, place, *r.best.high, &hit) || !is_shown(n, place, hit.front))
      return;
    if constexpr (Mode::kAll || Mode::kAny) {
      keep(n, place, r);
    } else {
      if (r.best.take_settled(triangles_, ray, place, hit.t)) shorten(n, r);
    }
  }

  /// Takes a hit within the ray's limits.
  void take(std::uint32_t n, std::uint32_t place, Interval t, bool front) {
    if (!is_shown(n, place, front)) return;
    const RayLimits r = self().limits_of(n);
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

 protected:
  [[nodiscard]] HWY_INLINE bool hits_are_chosen() const { return hits_are_chosen_; }

 private:
  [[nodiscard]] HWY_INLINE Self& self() { return static_cast<Self&>(*this); }
  [[nodiscard]] HWY_INLINE const Self& self() const { return static_cast<const Self&>(*this); }

  [[nodiscard]] HWY_INLINE bool is_shown(std::uint32_t n, std::uint32_t place, bool front) const {
    return !hits_are_chosen_ ||
           counts_as_hit(ray_job_.scene, self().number_of(n), id_at(triangles_, place), front);
  }

  /// Triangles with the same corners are hit at the same distance: if a ray's best hit is one of
  /// them, the least number counts, and nothing is computed. Returns whether that is so.
  [[nodiscard]] HWY_INLINE bool take_copy(std::uint32_t n, std::uint32_t place) {
    std::uint32_t* const best = self().limits_of(n).best.place;
    if (*best == kInvalidId || !have_same_corners(triangles_, *best, place)) return false;
    const std::uint32_t id = id_at(triangles_, place), best_id = id_at(triangles_, *best);
    const DualScene& scene = ray_job_.scene;
    if (hits_are_chosen_ && (scene.filter != nullptr || scene.flags[id] != scene.flags[best_id]))
      return false;
    if (id < best_id) *best = place;
    return true;
  }

  /// Shortens the ray to its best hit.
  HWY_INLINE void shorten(std::uint32_t n, const RayLimits& r) {
    *r.s_far = std::min(*r.s_far, raysheaf::past(*r.best.high, r.along) - r.start);
    self().ends(n);
  }

  /// Takes a hit whose distance does not matter.
  HWY_INLINE void keep(std::uint32_t n, std::uint32_t place, const RayLimits& r) {
    if constexpr (Mode::kAll) {
      self().store(n, place);
    } else {
      // Keeps the smallest place of a leaf, whatever the order in which a SIMD target finds them.
      *r.best.place = std::min(*r.best.place, place);
      *r.best.high = -1;
      *r.s_far = -std::numeric_limits<float>::infinity();
      self().ends(n);
    }
  }

  const TraceJob& ray_job_;
  const ObjectTree& triangles_;
  const bool hits_are_chosen_;  ///< some hits do not count
};

template <class Mode>
class StreamHits : StreamPart, public RayHits<Mode, StreamHits<Mode>> {
  using Base = RayHits<Mode, StreamHits<Mode>>;
  friend Base;

 public:
  explicit StreamHits(StreamState& state) : StreamPart(state), Base(state.job) {}

  /// Handles the hits of lanes [g, g + ray_lanes()) of rays: lane i is ray `number(i)`. `place` is
  /// that of a triangle in the tree's quads, four each; this holds for all functions that take
  /// hits.
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
      this->take(number(i), place, {low[i], high[i]}, (front >> i & 1) != 0);
    }
    settle_lanes(place, unsettled, number);
  }

  HWY_NOINLINE void take_lanes(std::uint32_t place, const std::uint32_t* bundle, std::uint32_t used,
                               std::size_t g, const Tested<Rays>& tested) {
    const std::uint32_t hit = bits_of(Rays(), tested.hit) & used >> g;
    std::uint32_t unsettled = bits_of(Rays(), tested.unsettled) & used >> g;
    if ((hit | unsettled) == 0) return;
    if (__builtin_popcount(unsettled) >= kFewestTogether && !stream_.are_far)
      unsettled &= ~beyond(place, bundle + g);
    take_each(place, hit, unsettled, tested, [&](std::uint32_t i) { return bundle[g + i]; });
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

  /// The same for all rays of a bundle at once. `beyond()`: the lanes that the triangle is surely
  /// beyond, as bits.
  template <class Beyond>
  HWY_NOINLINE void take_in_bundle(std::uint32_t place, BundleRays rays, std::size_t g,
                                   const Tested<Rays>& tested, const Beyond& beyond) {
    const Rays d;
    const std::uint32_t used = std::uint32_t{rays.rays} >> g;
    const std::uint32_t hit = bits_of(d, tested.hit) & used;
    std::uint32_t unsettled = bits_of(d, tested.unsettled) & used;
    if (unsettled != 0) unsettled &= ~beyond();
    if ((hit | unsettled) == 0) return;
    const auto first = static_cast<std::uint32_t>(rays.bundle * kBundleWidth + g);
    const auto number = [first](std::uint32_t i) { return first + i; };
    if (Mode::kAll || this->hits_are_chosen())
      return take_each(place, hit, unsettled, tested, number);
    StreamBundle& b = stream_.bundles[rays.bundle];
    const RayInts di;
    const RV limit = load(b.t_limit + g), far = load(b.s_far + g);
    const auto best = hn::Load(di, b.place + g);
    RV high, end;
    RM nearer = lanes_of(hit, 0);
    hn::Vec<RayInts> met = hn::Set(di, place);
    std::uint32_t rest = unsettled;
    if constexpr (Mode::kAny) {
      // Keeps the smallest place of a leaf, whatever the order in which a SIMD target finds them.
      met = hn::Min(best, met);
      high = set(-1);
      end = set(-std::numeric_limits<float>::infinity());
    } else {
      const RV low = load(b.t_low + g);
      nearer = hn::And(nearer, hn::Lt(tested.high, low));
      rest |= hit & ~bits_of(d, nearer);
      high = tested.high;
      end = hn::Min(past(high, load(b.along + g)), far);
      hn::Store(hn::IfThenElse(nearer, tested.low, low), d, b.t_low + g);
    }
    hn::Store(hn::IfThenElse(nearer, high, limit), d, b.t_limit + g);
    hn::Store(hn::IfThenElse(nearer, end, far), d, b.s_far + g);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, nearer), met, best), di, b.place + g);
    for (std::uint32_t turn = bits_of(d, nearer) & stream_.recorded[rays.bundle] >> g; turn != 0;
         turn &= turn - 1)
      tell_record(number(static_cast<std::uint32_t>(__builtin_ctz(turn))));
    settle_lanes(place, rest, number);
  }

  template <class Number>
  HWY_INLINE void settle_lanes(std::uint32_t place, std::uint32_t rest, const Number& number) {
    for (; rest != 0; rest &= rest - 1)
      this->settle(number(static_cast<std::uint32_t>(__builtin_ctz(rest))), place);
  }

  HWY_INLINE void prefetch_ray(std::uint32_t n) const { hwy::Prefetch(stream_.rays.data() + n); }

  void begin() const {}
  void write_back() {
    if constexpr (Mode::kAny) write_back_any();
    if constexpr (!Mode::kAny && !Mode::kAll) write_back_closest();
  }

 private:
  [[nodiscard]] HWY_INLINE RayLimits limits_of(std::uint32_t n) const {
    if (in_bundles_) {
      StreamBundle& b = bundle_of(n);
      const std::uint32_t i = n % kBundleWidth;
      return {{&b.t_low[i], &b.t_limit[i], &b.place[i]}, &b.s_far[i], b.along[i], start_of(n)};
    }
    StreamRay& r = stream_.rays[n];
    return {{&r.t_low, &r.t_limit, &r.place}, &r.s_far, r.along, start_of(n)};
  }
  [[nodiscard]] HWY_INLINE float start_of(std::uint32_t n) const {
    return stream_.are_far ? stream_.rays[n].start : 0;
  }
  [[nodiscard]] HWY_INLINE std::uint32_t number_of(std::uint32_t n) const {
    return stream_.index[n];
  }
  [[nodiscard]] HWY_INLINE const QuarterAxes& axes_of(std::uint32_t /*n*/) const { return stream_; }
  [[nodiscard]] HWY_INLINE SlopedRay sloped(std::uint32_t n) const {
    const bool has_record =
        !in_bundles_ || (stream_.recorded[n / kBundleWidth] >> n % kBundleWidth & 1) != 0;
    const StreamRay r = has_record ? stream_.rays[n] : bundle_of(n).ray(n % kBundleWidth);
    return sloped_ray(r, stream_, stream_.are_far, job_.rays[stream_.index[n]]);
  }
  [[nodiscard]] HWY_INLINE StreamBundle& bundle_of(std::uint32_t n) const {
    return stream_.bundles[n / kBundleWidth];
  }

  /// Copies a ray's limits from its bundle to its record.
  HWY_INLINE void tell_record(std::uint32_t n) {
    const StreamBundle& b = bundle_of(n);
    stream_.rays[n].t_limit = b.t_limit[n % kBundleWidth];
    stream_.rays[n].s_far = b.s_far[n % kBundleWidth];
  }
  HWY_INLINE void ends(std::uint32_t n) {
    if (in_bundles_) tell_record(n);
  }
  HWY_INLINE void store(std::uint32_t n, std::uint32_t place) {
    if (job_.results.rows == nullptr)
      ++job_.results.hit_counts.data[stream_.index[n]];
    else
      stream_.rows.push_back({stream_.first + n, {0, 0, 0, place}});
  }

  void write_back_any() {
    const RayStream& s = stream_;
    if (in_bundles_) {
      for (std::uint32_t base = 0; base < s.count; base += kBundleWidth) write_back_bundle(base);
    } else {
      for (std::uint32_t i = 0; i < s.count; ++i)
        job_.results.occluded.data[s.index[i]] = s.rays[i].place != kInvalidId ? 1 : 0;
    }
  }

  HWY_INLINE void write_back_bundle(std::uint32_t base) {
    const RayInts d;
    const std::uint32_t* const places = stream_.bundles[base / kBundleWidth].place;
    const std::uint32_t* const index = stream_.index.data() + base;
    const std::uint32_t n = std::min(kBundleWidth, stream_.count - base);
    std::uint32_t hit = 0;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
      hit |= bits_of(d, hn::Ne(hn::Load(d, places + g), hn::Set(d, kInvalidId))) << g;
    if (n == kBundleWidth && are_fours(index)) {
      for (std::uint32_t i = 0; i < kBundleWidth; i += 4)
        std::memcpy(job_.results.occluded.data + index[i], kBytesOfBits[hit >> i & 15], 4);
    } else {
      for (std::uint32_t i = 0; i < n; ++i)
        job_.results.occluded.data[index[i]] = static_cast<std::uint8_t>(hit >> i & 1);
    }
  }
  /// Four bits as four bytes.
  static constexpr std::uint8_t kBytesOfBits[16][4] = {
      {0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 0}, {1, 0, 1, 0},
      {0, 1, 1, 0}, {1, 1, 1, 0}, {0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {1, 1, 0, 1},
      {0, 0, 1, 1}, {1, 0, 1, 1}, {0, 1, 1, 1}, {1, 1, 1, 1}};
  /// Whether sixteen numbers are four times four consecutive ones.
  [[nodiscard]] static HWY_INLINE bool are_fours(const std::uint32_t* index) {
    std::uint32_t differ = 0;
    for (std::uint32_t i = 0; i < kBundleWidth; ++i) differ |= index[i] ^ (index[i & ~3u] + i % 4);
    return differ == 0;
  }

  /// Computes the values of sixteen hits while the corners of the next sixteen are being fetched.
  void write_back_closest() {
    const RayStream& s = stream_;
    alignas(64) IndexedHit hits[kBundleWidth];
    if (s.count != 0) fill_values(0);
    for (std::uint32_t base = 0; base < s.count; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, s.count - base), next = base + kBundleWidth;
      if (next < s.count) fill_values(next);
      values_[base / kBundleWidth % 2].store(hits);
      for (std::uint32_t i = 0; i < n; ++i) job_.results.hits.data[s.index[base + i]] = hits[i];
    }
  }

  HWY_INLINE void fill_values(std::uint32_t base) {
    const RayStream& s = stream_;
    const std::uint32_t ahead = std::min(base + kWritesAhead, s.count);
    for (std::uint32_t i = base + kWritesAhead - kBundleWidth; i < ahead; ++i)
      __builtin_prefetch(job_.results.hits.data + s.index[i], 1);
    alignas(64) std::uint32_t places[kBundleWidth];
    if (in_bundles_) {
      std::copy_n(s.bundles[base / kBundleWidth].place, kBundleWidth, places);
    } else {
      for (std::uint32_t i = 0; i < kBundleWidth; ++i) places[i] = s.rays[base + i].place;
    }
    values_[base / kBundleWidth % 2].fill(tree_, job_.rays, s.index.data() + base, places);
  }

  HitValues values_[2];
};

// Rays of a stream that share a subtree with few others: they are collected until there are enough
// of them, and then traced interleaved.

/// Lists up to this length continue ray by ray.
inline constexpr std::uint32_t kFewRays = 24;
/// The same limit for lists at a leaf.
inline constexpr std::uint32_t kFewRaysAtLeaf = 2;
/// Number of interleaved rays, and of those that are collected. Larger numbers leave fewer slots
/// idle, but the rest of the stream does not know the hits of collected rays.
inline constexpr std::uint32_t kSingleWalks = SingleWalks::kMost;
inline constexpr std::size_t kLeastPending = 64, kMostPending = 256;

struct PendingRay {
  std::uint32_t ray, first, count;  ///< where it continues, as in BvhNode
};

template <class Mode>
class StreamSingles : StreamPart {
 public:
  static constexpr bool kTwoLevels = false;

  StreamSingles(StreamState& state, StreamHits<Mode>& hits) : StreamPart(state), hits_(hits) {}

  [[nodiscard]] bool is_for_singles(const WaitingList& list) const {
    return list.size <= (list.count == 0 ? kFewRays : kFewRaysAtLeaf);
  }
  [[nodiscard]] bool has_many_singles() const { return pending_.size() >= kLeastPending; }

  void add_singles(const WaitingList& list) {
    if (pending_.size() + list.size > kMostPending) walk_all();
    for (std::uint32_t i = 0; i < list.size; ++i) {
      const std::uint32_t ray = stream_.lists[list.offset + i];
      hits_.prefetch_ray(ray);
      pending_.push_back({ray, list.first, list.count});
    }
  }

  void walk_all() {
    if (pending_.empty()) return;
    const PendingRay* next = pending_.data();
    const PendingRay* const end = next + pending_.size();
    walk_singles<!Mode::kAll>(
        OneTree(tree_, stream_), &singles_, kSingleWalks,
        [&](std::uint32_t i) {
          // Skips rays that later hits have finished or shortened.
          while (next != end && stream_.rays[next->ray].s_far < stream_.rays[next->ray].s_near)
            ++next;
          if (next == end) return false;
          job_.executor.check();
          singles_.number[i] = next->ray;
          singles_.ray[i] = &stream_.rays[next->ray];
          singles_.slabs[i] = SingleSlabs(stream_.rays[next->ray], stream_);
          singles_.start(i, next->first, next->count);
          ++next;
          return true;
        },
        [&](std::uint32_t i, std::uint32_t place, Interval t, bool front) {
          hits_.take(singles_.number[i], place, t, front);
        },
        [&](std::uint32_t i, std::uint32_t place) { hits_.settle(singles_.number[i], place); },
        &counts_);
    pending_.clear();
  }

 private:
  StreamHits<Mode>& hits_;
  SingleWalks singles_;
  std::vector<PendingRay> pending_;
};

// Lists of a stream's rays, from node to node.

/// Appends the numbers of a group's set lanes; needs room for kBundleWidth. Returns the new end.
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

/// Appends `first` + the number of each of a bundle's set lanes; needs room for kBundleWidth more.
/// Returns the new end.
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

/// The boxes of a node's children, moved outwards, and relative to an origin.
class SeenBoxes {
 public:
  HWY_INLINE SeenBoxes(const BvhNode& node, const RayStream& s, Vec3 o) {
    const Boxes d;
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
      const auto seen = [&](int row, float from) HWY_ATTR {
        const BV at = hn::Load(d, node.bound[row] + g);
        const BV by = hn::Add(hn::Mul(hn::Abs(at), hn::Set(d, 2 * kUnitRoundoff)),
                              hn::Set(d, s.growth.least));
        return hn::Sub(row < 3 ? hn::Sub(at, by) : hn::Add(at, by), hn::Set(d, from));
      };
      hn::Store(seen(s.near_x, o.x), d, x_near_ + g), hn::Store(seen(s.far_x, o.x), d, x_far_ + g);
      hn::Store(seen(s.near_y, o.y), d, y_near_ + g), hn::Store(seen(s.far_y, o.y), d, y_far_ + g);
      const BV z_near = seen(s.near_z, o.z), z_far = seen(s.far_z, o.z);
      hn::Store(s.mirrored ? hn::Neg(z_near) : z_near, d, z_near_ + g);
      hn::Store(s.mirrored ? hn::Neg(z_far) : z_far, d, z_far_ + g);
    }
  }
  [[nodiscard]] HWY_INLINE SeenBox of(std::uint32_t c) const {
    return {x_near_[c], x_far_[c], y_near_[c], y_far_[c], z_near_[c], z_far_[c]};
  }

 private:
  alignas(32) float x_near_[kBvhWidth], x_far_[kBvhWidth], y_near_[kBvhWidth], y_far_[kBvhWidth];
  alignas(32) float z_near_[kBvhWidth], z_far_[kBvhWidth];
};

/// The fields for tests with boxes, of as many rays as a vector has lanes. The origins that near
/// and far planes are seen from are the same for rays whose origins are not moved.
struct SlabRays {
  RV x_near, y_near, z_near, x_far, y_far, z_far, per_x, per_y, s_near, s_far;
};

/// The fields for tests with triangles, of as many rays.
struct LeafRays {
  RV ox, oy, oz, t_limit, shear_x, shear_y, shear_z, t_min;
};

/// The lanes that intersect the box within [s_near, s_far].
HWY_INLINE RM meeting(const SlabRays& r, const SeenBox& box) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  const RV x0 = Mul(Sub(set(box.x_near), r.x_near), r.per_x);
  const RV x1 = Mul(Sub(set(box.x_far), r.x_far), r.per_x);
  const RV y0 = Mul(Sub(set(box.y_near), r.y_near), r.per_y);
  const RV y1 = Mul(Sub(set(box.y_far), r.y_far), r.per_y);
  const RV near = Max(Max(x0, y0), Max(Sub(set(box.z_near), r.z_near), r.s_near));
  const RV far = Min(Min(x1, y1), Min(Sub(set(box.z_far), r.z_far), r.s_far));
  return hn::Le(near, Mul(far, set(kFarther)));
}

/// The same for a box relative to the rays' common origin.
HWY_INLINE RM meeting_from_origin(RV per_x, RV per_y, RV s_near, RV s_far, const SeenBox& box) {
  using hn::Max, hn::Min, hn::Mul;
  const RV near = Max(Max(Mul(set(box.x_near), per_x), Mul(set(box.y_near), per_y)),
                      Max(set(box.z_near), s_near));
  const RV far =
      Min(Min(Mul(set(box.x_far), per_x), Mul(set(box.y_far), per_y)), Min(set(box.z_far), s_far));
  return hn::Le(near, Mul(far, set(kFarther)));
}

/// Lists at a leaf up to this length test some rays with four triangles at once, instead of as many
/// rays as there are lanes with one triangle. Without this, rays take 1.01 of the time.
inline constexpr std::uint32_t kFewAtQuads = 8;

template <class Hits, class Singles>
class StreamLists : StreamPart {
 public:
  StreamLists(StreamState& state, Hits& hits, Singles& singles)
      : StreamPart(state), hits_(hits), singles_(singles) {}

  /// Processes the node or leaf of a list.
  void meet(const WaitingList& list) {
    if (singles_.is_for_singles(list)) {
      singles_.add_singles(list);
      return;
    }
    if (singles_.has_many_singles()) singles_.walk_all();
    if (list.count == 0)
      open(list);
    else if constexpr (!Singles::kTwoLevels)
      meet_leaf(list);
  }

  /// Appends numbers to a list, so that its last bundle is read like the others.
  void pad_list(std::uint32_t offset, std::uint32_t size) {
    std::uint32_t* end = stream_.lists.data() + offset + size;
    const RayInts d;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
      hn::StoreU(hn::Set(d, end[-1]), d, end + g);
  }

  /// Sorts the children from far to near along the stream's axis. A child's position is the number
  /// of children before it, computed without unpredictable branches.
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

  /// Prefetches the rays of the bundle after the next; at a list's beginning also those of the
  /// next.
  HWY_INLINE void prefetch_rays(const WaitingList& list, std::uint32_t base) const {
    const std::uint32_t* const numbers = stream_.lists.data() + list.offset;
    const std::uint32_t end = std::min(base + 3 * kBundleWidth, list.size);
    for (std::uint32_t i = base + (base == 0 ? 1 : 2) * kBundleWidth; i < end; ++i)
      hits_.prefetch_ray(numbers[i]);
  }

  void meet_leaf(const WaitingList& list) {
    const RayStream& s = stream_;
    counts_.triangle_tests += std::uint64_t{list.size} * list.count;
    if (list.size <= kFewAtQuads) return meet_leaf_by_quads(list);
    const std::uint32_t* numbers = s.lists.data() + list.offset;
    for (std::uint32_t base = 0; base < list.size; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, list.size - base);
      const std::uint32_t* bundle = numbers + base;
      const std::uint32_t used = n == kBundleWidth ? 0xffffu : (1u << n) - 1;
      prefetch_rays(list, base);
      for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
        meet_group(4 * list.first, list.count, bundle, used, g);
    }
  }

  /// The same, with some rays and four triangles at once.
  HWY_NOINLINE void meet_leaf_by_quads(const WaitingList& list) {
    const std::uint32_t* numbers = stream_.lists.data() + list.offset;
    QuadHits hits;
    for (std::uint32_t n = 0; n < list.count; n += kQuadTriangles) {
      const TriangleQuad* const quad = &tree_.quads[list.first + n / kQuadTriangles];
      meet_quads(
          stream_.are_far, list.size,
          [&](std::uint32_t) HWY_ATTR { return static_cast<const QuarterAxes*>(&stream_); },
          [&](std::uint32_t i) HWY_ATTR { return stream_.rays.data() + numbers[i]; },
          [&](std::uint32_t) HWY_ATTR { return quad; }, &hits);
      const std::uint32_t here = std::min(kQuadTriangles, list.count - n);
      const std::uint64_t used = ((std::uint64_t{1} << here) - 1) * 0x1111111111111111u &
                                 ((std::uint64_t{1} << 4 * list.size) - 1);
      const std::uint32_t place = 4 * list.first + n;
      for (std::uint64_t turn = hits.hit & used; turn != 0; turn &= turn - 1) {
        const std::uint32_t b = first_of(turn);
        hits_.take(numbers[b / 4], place + b % 4, hits.at(b), hits.is_front(b));
      }
      for (std::uint64_t turn = hits.unsettled & used; turn != 0; turn &= turn - 1) {
        const std::uint32_t b = first_of(turn);
        hits_.settle(numbers[b / 4], place + b % 4);
      }
    }
  }

  /// Tests triangles from a place on with the lanes of a bundle from `g` on.
  HWY_INLINE void meet_group(std::uint32_t first, std::uint32_t count, const std::uint32_t* bundle,
                             std::uint32_t used, std::size_t g) {
    LeafRays r;
    gather4(stream_.rays.data(), 0, bundle + g, r.ox, r.oy, r.oz, r.t_limit);
    gather4(stream_.rays.data(), 1, bundle + g, r.shear_x, r.shear_y, r.shear_z, r.t_min);
    for (std::uint32_t place = first; place < first + count; ++place) {
      Tested<Rays> tested;
      if (test_at(place, r, &tested)) hits_.take_lanes(place, bundle, used, g, tested);
    }
  }

  /// Corner `c` of the triangle at a place, moved to the rays' origins and sheared.
  [[nodiscard]] HWY_INLINE Corner<Rays> seen_corner(std::uint32_t place, int c, RV ox, RV oy, RV oz,
                                                    RV shear_x, RV shear_y) const {
    const auto& corner = tree_.quads[place / 4].vertex[c];
    const std::uint32_t k = place % 4;
    const auto from = [&](int axis, RV o) HWY_ATTR { return hn::Sub(set(corner[axis][k]), o); };
    return sheared(Rays(), from(stream_.axis_x, ox), from(stream_.axis_y, oy),
                   from(stream_.axis_z, oz), shear_x, shear_y);
  }
  [[nodiscard]] HWY_INLINE RV reach_at(std::uint32_t place) const {
    return set(tree_.quads[place / 4].reach[place % 4]);
  }

  /// Tests the triangle at a place; returns false if no ray can hit it.
  [[nodiscard]] HWY_INLINE bool test_at(std::uint32_t place, const LeafRays& r,
                                        Tested<Rays>* tested) const {
    const auto corner = [&](int c) HWY_ATTR {
      return seen_corner(place, c, r.ox, r.oy, r.oz, r.shear_x, r.shear_y);
    };
    if (HWY_UNLIKELY(stream_.are_far)) {
      test_far_lanes(Rays(), corner(0), corner(1), corner(2), reach_at(place), r.t_min, tested);
      return !hn::AllFalse(Rays(), tested->unsettled);
    }
    return test_lanes(Rays(), corner(0), corner(1), corner(2), reach_at(place), r.shear_z, r.t_min,
                      r.t_limit, tested);
  }

 private:
  [[nodiscard]] HWY_INLINE SlabRays gather_slabs(const std::uint32_t* numbers) const {
    const RayStream& s = stream_;
    SlabRays r;
    RV x, y, z, unused[3], pad;
    gather4(s.rays.data(), 0, numbers, x, y, z, pad);
    gather4(s.rays.data(), 2, numbers, r.per_x, r.per_y, r.s_near, r.s_far);
    if (s.mirrored) z = hn::Neg(z);
    r.x_near = r.x_far = x, r.y_near = r.y_far = y, r.z_near = r.z_far = z;
    if (HWY_LIKELY(!s.are_far)) return r;
    gather4(s.rays.data(), 1, numbers, unused[0], unused[1], unused[2], pad);
    // A plane moves outwards if the origin moves the other way.
    const auto apart = [&](RV from, bool rises, RV* near, RV* far) HWY_ATTR {
      *near = rises ? hn::Add(from, pad) : hn::Sub(from, pad);
      *far = rises ? hn::Sub(from, pad) : hn::Add(from, pad);
    };
    apart(x, s.near_x < 3, &r.x_near, &r.x_far);
    apart(y, s.near_y < 3, &r.y_near, &r.y_far);
    apart(z, true, &r.z_near, &r.z_far);
    return r;
  }

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
    const SeenBoxes boxes(node, s, {});
    std::uint32_t* out[kBvhWidth];
    for (std::uint32_t k = 0; k < child_count; ++k) out[k] = s.lists.data() + bottom + room * k;
    const RV nowhere = set(-std::numeric_limits<float>::infinity());
    const std::uint32_t* numbers = s.lists.data() + list.offset;
    for (std::uint32_t base = 0; base < list.size; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, list.size - base);
      const std::uint32_t* bundle = numbers + base;
      const std::uint32_t used = n == kBundleWidth ? 0xffffu : (1u << n) - 1;
      prefetch_rays(list, base);
      for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
        SlabRays rays = gather_slabs(bundle + g);
        rays.s_far = hn::IfThenElse(lanes_of(used, g), rays.s_far, nowhere);
        for (std::uint32_t k = 0; k < child_count; ++k)
          out[k] = append_set(bundle + g, meeting(rays, boxes.of(children[k])), out[k]);
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

  Hits& hits_;
  Singles& singles_;
};

// Traces bundles of a stream's rays from node to node, while most rays of a bundle stay together.
//
//   list    5: 1111111111111111   6: 1111111111110000   7: ...     bundles, and their rays in it
//             | |                     the beams of sixteen bundles are tested with a box at once,
//             v v                     and their rays only with boxes that their beam intersects
//   child   5: 0000001111111111   6: 1111000000000000
//
// Rays are read in place, neither gathered nor moved. When bundles have lost too many rays, the
// rest continues as a list of rays.

/// Bundles with fewer rays each, on average, continue as rays.
inline constexpr std::uint32_t kRaysOfBundle = 6;
/// The same limit for bundles at a leaf.
inline constexpr std::uint32_t kRaysOfBundleAtLeaf = 4;

/// Up to this many rays of a bundle get records one by one; more of them all at once.
inline constexpr int kFewRecords = 3;

/// The beams of as many bundles as a vector has lanes.
struct BeamLanes {
  RV z_low, z_high, start, end;
  struct Planes {
    RV at, inverse;
    RM opens;  ///< the plane recedes from its axis's lower end
  };
  Planes x_low, x_high, y_low, y_high;

  /// `words`: BundleRays.
  HWY_INLINE BeamLanes(const Beam* beams, const std::uint32_t* words) {
    static_assert(sizeof(BundleRays) == 4);
    const RayInts d;
    alignas(64) std::uint32_t bundles[kBundleWidth];
    hn::Store(hn::And(hn::Load(d, words), hn::Set(d, 0xffff)), d, bundles);
    gather4(beams, 0, bundles, z_low, z_high, start, end);
    gather4(beams, 1, bundles, x_low.at, x_low.inverse, x_high.at, x_high.inverse);
    gather4(beams, 2, bundles, y_low.at, y_low.inverse, y_high.at, y_high.inverse);
    for (Planes* planes : {&x_low, &x_high, &y_low, &y_high})
      planes->opens = hn::Gt(planes->inverse, hn::Zero(Rays()));
  }

  /// The lanes whose beams intersect a child.
  HWY_INLINE RM meeting(const RayStream& s, const BvhNode& node, std::uint32_t c) const {
    using hn::Max, hn::Min, hn::Mul, hn::Sub;
    const RV z0 = set(node.bound[s.near_z][c]), z1 = set(node.bound[s.far_z][c]);
    RV lo = Max(s.mirrored ? Sub(z_low, z0) : Sub(z0, z_high), start);
    RV hi = Min(s.mirrored ? Sub(z_high, z1) : Sub(z1, z_low), end);
    const auto clip = [&](const Planes& planes, float bound, bool low) HWY_ATTR {
      const RV zeta = Mul(Sub(set(bound), planes.at), planes.inverse);
      const RV less = Min(hi, zeta), more = Max(lo, zeta);
      hi = low ? hn::IfThenElse(planes.opens, less, hi) : hn::IfThenElse(planes.opens, hi, less);
      lo = low ? hn::IfThenElse(planes.opens, lo, more) : hn::IfThenElse(planes.opens, more, lo);
    };
    clip(x_low, node.bound[s.axis_x + 3][c], true);
    clip(x_high, node.bound[s.axis_x][c], false);
    clip(y_low, node.bound[s.axis_y + 3][c], true);
    clip(y_high, node.bound[s.axis_y][c], false);
    return hn::Le(lo, hi);
  }
};

template <class Hits, class Lists>
class StreamBundles : StreamPart {
 public:
  StreamBundles(StreamState& state, Hits& hits, Lists& lists)
      : StreamPart(state), hits_(hits), lists_(lists) {}

  /// Gives the rays `some` of a bundle their own records.
  HWY_INLINE void leave_bundle(std::uint32_t bundle, std::uint32_t some) {
    const std::uint32_t leave = some & ~stream_.recorded[bundle];
    if (leave != 0) make_records(bundle, leave);
  }

  void meet_leaf(const WaitingList& list) {
    const auto* from = reinterpret_cast<const BundleRays*>(stream_.lists.data() + list.offset);
    std::uint32_t rays = 0;
    for (std::uint32_t i = 0; i < list.size; ++i)
      rays += static_cast<std::uint32_t>(__builtin_popcount(from[i].rays));
    counts_.triangle_tests += std::uint64_t{rays} * list.count;
    for (std::uint32_t done = 0; done < list.count; done += kQuadTriangles) {
      const std::uint32_t place = 4 * list.first + done;
      const std::uint32_t count = std::min(kQuadTriangles, list.count - done);
      stream_.one_start ? meet_quad_from_origin(place, count, from, list.size)
                        : meet_quad(place, count, from, list.size);
    }
  }

  void open(const WaitingList& list) {
    RayStream& s = stream_;
    const BvhNode& node = tree_.nodes[list.first];
    std::uint32_t children[kBvhWidth], found[kBvhWidth];
    const std::uint32_t child_count = lists_.sorted_children(node, children);
    counts_.beam_box_tests += std::uint64_t{list.size} * child_count;
    meet_beams(node, list, found);
    const SeenBoxes boxes(node, s, s.one_start ? s.origin : Vec3{});
    std::uint32_t end = list.offset;
    for (std::uint32_t k = 0; k < child_count; ++k) {
      const std::uint32_t c = children[k];
      const SeenBox box = boxes.of(c);
      BundleRays* const rows = found_[c];
      std::uint32_t bundles = 0, tests = 0, rays = 0;
      for (std::uint32_t i = 0; i < found[c]; ++i) {
        const BundleRays before = rows[i];
        const std::uint32_t met = rays_in_box(s.bundles[before.bundle], box) & before.rays;
        tests += static_cast<std::uint32_t>(__builtin_popcount(before.rays));
        rays += static_cast<std::uint32_t>(__builtin_popcount(met));
        rows[bundles] = {before.bundle, static_cast<std::uint16_t>(met)};
        bundles += met != 0 ? 1 : 0;
      }
      counts_.ray_box_tests += tests;
      if (bundles == 0) continue;
      const bool together =
          rays >= (node.is_leaf(c) ? kRaysOfBundleAtLeaf : kRaysOfBundle) * bundles;
      const std::uint32_t size = together ? bundles : rays;
      s.grow_lists(std::size_t{end} + size + 2 * kBundleWidth);
      if (together) {
        keep_bundles(c, bundles, end);
      } else {
        keep_rays(c, bundles, end);
        lists_.pad_list(end, size);
      }
      s.waiting.push_back({node.first[c], node.count[c], end, size, together});
      subtrees_.prefetch(node.first[c], node.count[c]);
      end += (size + kBundleWidth + 15) / 16 * 16;
    }
  }

 private:
  static constexpr std::uint32_t kMostBundles = kStreamRays / kBundleWidth;

  /// Lanes of a bundle that may hit a triangle of a quad: which bundle of the list, the first lane,
  /// and which triangle.
  struct Candidate {
    std::uint16_t bundle;
    std::uint8_t g, triangle;
  };

  /// Tests triangles of a quad, from a place on, with bundles. All misses are found first, without
  /// a branch that depends on them; then the rest is tested completely.
  HWY_NOINLINE void meet_quad(std::uint32_t place, std::uint32_t count, const BundleRays* from,
                              std::uint32_t size) {
    Candidate* end = candidates_;
    for (std::uint32_t i = 0; i < size; ++i) {
      const StreamBundle& b = stream_.bundles[from[i].bundle];
      for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
        const RV ox = load(b.ox + g), oy = load(b.oy + g), oz = load(b.oz + g);
        const RV shear_x = load(b.shear_x + g), shear_y = load(b.shear_y + g);
        for (std::uint32_t k = 0; k < count; ++k) {
          const auto corner = [&](int c) HWY_ATTR {
            return lists_.seen_corner(place + k, c, ox, oy, oz, shear_x, shear_y);
          };
          const auto edges =
              edges_of(Rays(), corner(0), corner(1), corner(2), lists_.reach_at(place + k));
          end = append(end, i, g, k, edges.possible);
        }
      }
    }
    for (const Candidate* c = candidates_; c != end; ++c) {
      const StreamBundle& b = stream_.bundles[from[c->bundle].bundle];
      const std::size_t g = c->g;
      const LeafRays r{load(b.ox + g),      load(b.oy + g),      load(b.oz + g),
                       load(b.t_limit + g), load(b.shear_x + g), load(b.shear_y + g),
                       load(b.shear_z + g), load(b.t_min + g)};
      const std::uint32_t at = place + c->triangle;
      Tested<Rays> tested;
      if (lists_.test_at(at, r, &tested))
        hits_.take_in_bundle(at, from[c->bundle], g, tested, [&] {
          return lanes_beyond_plane(tree_, stream_, at, columns_from(b, g));
        });
    }
  }

  /// The same if all rays have one origin.
  HWY_NOINLINE void meet_quad_from_origin(std::uint32_t place, std::uint32_t count,
                                          const BundleRays* from, std::uint32_t size) {
    const QuadFromOrigin quad(tree_.quads[place / 4], stream_, stream_.origin);
    Candidate* end = candidates_;
    for (std::uint32_t i = 0; i < size; ++i) {
      const StreamBundle& b = stream_.bundles[from[i].bundle];
      for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
        const RV shear_x = load(b.shear_x + g), shear_y = load(b.shear_y + g);
        for (std::uint32_t k = 0; k < count; ++k)
          end = append(end, i, g, k, hn::Not(EdgeSides(quad, k, shear_x, shear_y).miss()));
      }
    }
    for (const Candidate* c = candidates_; c != end; ++c) {
      const StreamBundle& b = stream_.bundles[from[c->bundle].bundle];
      const std::size_t g = c->g;
      const LeafRaysOfOrigin r{load(b.shear_x + g), load(b.shear_y + g), load(b.shear_z + g),
                               load(b.t_min + g), load(b.t_limit + g)};
      hits_.take_in_bundle(place + c->triangle, from[c->bundle], g,
                           test_from_origin(quad, c->triangle, r),
                           [&] { return lanes_beyond_from_origin(quad, c->triangle, b, g); });
    }
  }

  static HWY_INLINE Candidate* append(Candidate* end, std::uint32_t bundle, std::size_t g,
                                      std::uint32_t triangle, RM possible) {
    *end = {static_cast<std::uint16_t>(bundle), static_cast<std::uint8_t>(g),
            static_cast<std::uint8_t>(triangle)};
    return end + (hn::AllFalse(Rays(), possible) ? 0 : 1);
  }

  HWY_NOINLINE void make_records(std::uint32_t bundle, std::uint32_t leave) {
    const StreamBundle& b = stream_.bundles[bundle];
    StreamRay* const rays = stream_.rays.data() + std::size_t{bundle} * kBundleWidth;
    if (__builtin_popcount(leave) <= kFewRecords) {
      stream_.recorded[bundle] |= leave;
      for (; leave != 0; leave &= leave - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(leave));
        rays[lane] = b.ray(lane);
      }
      return;
    }
    stream_.recorded[bundle] = 0xffff;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
      const auto put = [&](int quad, const float* f0, const float* f1, const float* f2,
                           const float* f3) HWY_ATTR {
        store4(load(f0 + g), load(f1 + g), load(f2 + g), load(f3 + g), quad, rays + g);
      };
      put(0, b.ox, b.oy, b.oz, b.t_limit);
      put(1, b.shear_x, b.shear_y, b.shear_z, b.t_min);
      put(2, b.per_x, b.per_y, b.s_near, b.s_far);
    }
  }

  /// Needs room for kBundleWidth more.
  void keep_bundles(std::uint32_t c, std::uint32_t bundles, std::uint32_t offset) {
    std::memcpy(stream_.lists.data() + offset, found_[c], bundles * sizeof(BundleRays));
    lists_.pad_list(offset, bundles);
  }

  /// Converts the bundles to a list of rays; needs room for kBundleWidth more.
  void keep_rays(std::uint32_t c, std::uint32_t bundles, std::uint32_t offset) {
    std::uint32_t* out = stream_.lists.data() + offset;
    for (std::uint32_t i = 0; i < bundles; ++i) {
      const BundleRays from = found_[c][i];
      leave_bundle(from.bundle, from.rays);
      out = append_lanes(from.bundle * kBundleWidth, from.rays, out);
    }
  }

  /// The rays of a bundle that intersect a box, which is relative to their origin if they have one.
  HWY_INLINE std::uint32_t rays_in_box(const StreamBundle& b, const SeenBox& box) const {
    std::uint32_t met = 0;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
      if (stream_.one_start) {
        met |= bits_of(Rays(), meeting_from_origin(load(b.per_x + g), load(b.per_y + g),
                                                   load(b.s_near + g), load(b.s_far + g), box))
               << g;
        continue;
      }
      const RV x = load(b.ox + g), y = load(b.oy + g), along = load(b.oz + g);
      const RV z = stream_.mirrored ? hn::Neg(along) : along;
      const SlabRays rays{x,
                          y,
                          z,
                          x,
                          y,
                          z,
                          load(b.per_x + g),
                          load(b.per_y + g),
                          load(b.s_near + g),
                          load(b.s_far + g)};
      met |= bits_of(Rays(), meeting(rays, box)) << g;
    }
    return met;
  }

  /// Finds the bundles whose beams intersect each child, and how many they are. Tests as many beams
  /// as there are lanes with one child at a time.
  HWY_NOINLINE void meet_beams(const BvhNode& node, const WaitingList& list, std::uint32_t* found) {
    std::uint32_t* out[kBvhWidth];
    for (std::uint32_t c = 0; c < node.children; ++c)
      out[c] = reinterpret_cast<std::uint32_t*>(found_[c]);
    const std::uint32_t* const words = stream_.lists.data() + list.offset;
    const auto lanes = static_cast<std::uint32_t>(ray_lanes());
    for (std::uint32_t base = 0; base < list.size; base += lanes) {
      const std::uint32_t n = std::min(lanes, list.size - base);
      const RM some = lanes_of((1u << n) - 1, 0);
      const BeamLanes beams(stream_.beams.data(), words + base);
      for (std::uint32_t c = 0; c < node.children; ++c)
        out[c] = append_set(words + base, hn::And(beams.meeting(stream_, node, c), some), out[c]);
    }
    for (std::uint32_t c = 0; c < node.children; ++c)
      found[c] = static_cast<std::uint32_t>(out[c] - reinterpret_cast<std::uint32_t*>(found_[c]));
  }

  Hits& hits_;
  Lists& lists_;
  alignas(64) BundleRays found_[kBvhWidth][kMostBundles + kBundleWidth];  ///< by child
  static constexpr std::size_t kGroups = kBundleWidth / hn::MaxLanes(Rays());
  Candidate candidates_[kMostBundles * kGroups * kQuadTriangles + 1];
};

/// Streams with fewer rays have no pilots: single rays are slower.
inline constexpr std::uint32_t kFewestPiloted = 512;
/// Number of pilots traced before their benefit is evaluated.
inline constexpr std::uint32_t kPilots = 64;

/// With `Singles::kTwoLevels` the leaves of the tree are other trees: `Singles::enter(list)` takes
/// the rays of a list there.
template <class Mode, class Hits = StreamHits<Mode>, class Singles = StreamSingles<Mode>>
class StreamWalk {
 public:
  explicit StreamWalk(const StreamJob& job) : StreamWalk(job, Subtrees(*job.scene.tree)) {}
  template <class... Given>
  StreamWalk(const StreamJob& job, const Subtrees& subtrees, const Given&... given)
      : state_(job, subtrees), hits_(state_, given...) {}

  /// Traces the bundles of a task: consecutive ones of one quarter form a stream.
  DualCounts run(const TraceTask& task) {
    const std::uint32_t most = state_.in_bundles ? kStreamRays : kLongStreamRays;
    for (std::size_t n = task.begin; n < task.end;) {
      const BundleRange first = state_.job.bundle(n);
      std::uint32_t count = first.count;
      for (++n; n < task.end && count + kBundleWidth <= most; ++n) {
        const BundleRange next = state_.job.bundle(n);
        if (next.quarter != first.quarter) break;
        count += next.count;
      }
      trace_stream(first.first, count, first.quarter);
    }
    if constexpr (Mode::kAll) hand_over_rows(state_.job, task, state_.stream.rows);
    return state_.counts;
  }

 private:
  /// Traces rays [first, first + count) of the order, all of one quarter.
  void trace_stream(std::uint32_t first, std::uint32_t count, std::uint32_t quarter) {
    const DualCounts before = state_.counts;
    std::uint32_t alive = fill(first, count, quarter);
    hits_.begin();
    if constexpr (Mode::kAny && !Singles::kTwoLevels) {
      if (!state_.in_bundles) alive = follow_pilots(alive);
    }
    walk(0, alive, state_.in_bundles);
    if (HWY_UNLIKELY(!far_.empty())) walk_far();
    hits_.write_back();
    if (!state_.job.results.ray_tests.empty()) {
      const float share =
          static_cast<float>(state_.counts.sum() - before.sum()) / static_cast<float>(count);
      for (std::uint32_t i = 0; i < count; ++i)
        state_.job.results.ray_tests.data[state_.stream.index[i]] += share;
    }
  }

  /// Traces `size` rays or bundles, ascending, from `offset` on in the lists, through the tree;
  /// overwrites them.
  void walk(std::uint32_t offset, std::uint32_t size, bool in_bundles) {
    if (size == 0) return;
    state_.stream.waiting.clear();
    state_.stream.waiting.push_back({0, 0, offset, size, in_bundles});
    while (!state_.stream.waiting.empty()) {
      state_.job.executor.check();
      const WaitingList next = state_.stream.waiting.back();
      state_.stream.waiting.pop_back();
      meet_list(next);
    }
    singles_.walk_all();
  }

  /// Processes the node or leaf of a list.
  HWY_INLINE void meet_list(const WaitingList& list) {
    if constexpr (Singles::kTwoLevels) {
      if (list.count != 0) return singles_.enter(list);
    }
    if (!list.in_bundles) {
      lists_.meet(list);
    } else if (list.count == 0) {
      bundles_.open(list);
    } else if constexpr (!Singles::kTwoLevels) {
      bundles_.meet_leaf(list);
    }
  }

  /// Fills the stream's rays, and the list of those that intersect the scene's box, or of their
  /// bundles; returns the list's size.
  std::uint32_t fill(std::uint32_t first, std::uint32_t count, std::uint32_t quarter) {
    RayStream& s = state_.stream;
    s.fit(count);
    static_cast<QuarterAxes&>(s) = QuarterAxes(quarter);
    s.first = first;
    s.count = count;
    s.growth = Growth(state_.tree.bounds);
    s.one_start = state_.in_bundles && state_.job.order.one_start;
    state_.counts.ray_box_tests += count;
    along_ = hn::Zero(Rays());
    const std::uint32_t alive = s.one_start ? fill_from_start() : fill_rays();
    s.growth.include(hn::GetLane(hn::MaxOfLanes(Rays(), along_)));
    if (alive != 0) lists_.pad_list(0, alive);
    return alive;
  }

  /// Copies the numbers of the stream's rays from `base` on, sixteen or those that are left;
  /// returns how many.
  HWY_INLINE std::uint32_t take_numbers(std::uint32_t base) {
    RayStream& s = state_.stream;
    const std::uint32_t* order = state_.job.order.rays.data() + s.first;
    const std::uint32_t n = std::min(kBundleWidth, s.count - base);
    const std::uint32_t ahead = base + 8 * kBundleWidth;
    if (ahead + kBundleWidth <= s.count &&
        order[ahead + kBundleWidth - 1] - order[ahead] != kBundleWidth - 1) {
      for (std::uint32_t i = 0; i < kBundleWidth; ++i)
        hwy::Prefetch(state_.job.rays + order[ahead + i]);
    }
    copy_numbers(order + base, n, s.index.data() + base);
    return n;
  }

  HWY_INLINE std::uint32_t fill_rays() {
    RayStream& s = state_.stream;
    const SceneBox scene(state_.tree.bounds, s);
    std::uint32_t* end = s.lists.data();
    for (std::uint32_t base = 0; base < s.count; base += kBundleWidth) {
      const std::uint32_t n = take_numbers(base), bundle = base / kBundleWidth;
      const PreparedLanes prepared =
          prepare_lanes(state_.job.rays, s.index.data() + base, n, scene, s,
                        [&](std::size_t g, const RayLanes& r, const SlabLanes& slabs) HWY_ATTR {
                          along_ = hn::Max(along_, slabs.along);
                          keep_lanes(base, g, r, slabs);
                        });
      if (state_.in_bundles) s.recorded[bundle] = 0;
      if (HWY_UNLIKELY(prepared.far != 0)) keep_far(base, prepared.far);
      if (state_.in_bundles) {
        if (prepared.lanes == 0) continue;
        s.beams[bundle] = make_beam(prepared.lanes, s.bundles[bundle], s.mirrored, s.growth);
        *end++ = word_of(bundle, prepared.lanes);
      } else {
        end = append_lanes(base, prepared.lanes, end);
      }
    }
    return static_cast<std::uint32_t>(end - s.lists.data());
  }

  /// The same for bundles whose rays all have one origin and one t_min.
  HWY_NOINLINE std::uint32_t fill_from_start() {
    RayStream& s = state_.stream;
    const Ray* const rays = state_.job.rays;
    const QuarterAxes axes = s;
    const SharedStart start(rays[state_.job.order.rays[s.first]], axes);
    const SceneBox scene(state_.tree.bounds, axes);
    const Vec3 o = start.origin;
    const BoxFromOrigins box(scene, set(o.x), set(o.y), set(o.z));
    const bool is_far = bits_of(Rays(), scene.is_far(set(o.x), set(o.y), set(o.z))) != 0;
    s.origin = o;
    std::uint32_t* end = s.lists.data();
    for (std::uint32_t base = 0; base < s.count; base += kBundleWidth) {
      const std::uint32_t n = take_numbers(base), bundle = base / kBundleWidth;
      StreamBundle& b = s.bundles[bundle];
      const std::uint32_t lanes = prepare_from_start(
          start, box, axes, rays, s.index.data() + base, n,
          [&](std::size_t g, const RayLanes& r, const SlabLanes& slabs) HWY_ATTR {
            along_ = hn::Max(along_, slabs.along);
            keep_in_bundle(&b, g, r, slabs);
          });
      s.recorded[bundle] = 0;
      if (HWY_UNLIKELY(is_far)) {
        keep_far(base, n < kBundleWidth ? (1u << n) - 1 : 0xffffu);
      } else if (lanes != 0) {
        s.beams[bundle] = make_beam_from_start(start, lanes, b, axes.mirrored, s.growth);
        *end++ = word_of(bundle, lanes);
      }
    }
    return static_cast<std::uint32_t>(end - s.lists.data());
  }

  /// Stores them as rays `base` + `g` and following.
  HWY_INLINE void keep_lanes(std::uint32_t base, std::size_t g, const RayLanes& r,
                             const SlabLanes& slabs) {
    RayStream& s = state_.stream;
    const Rays d;
    const RayInts di;
    if (state_.in_bundles) {
      keep_in_bundle(&s.bundles[base / kBundleWidth], g, r, slabs);
      return;
    }
    StreamRay* const rays = s.rays.data() + base + g;
    const RV none = hn::BitCast(d, hn::Set(di, kInvalidId));
    store4(r.ox, r.oy, r.oz, r.t_limit, 0, rays);
    store4(slabs.shear_x, slabs.shear_y, slabs.shear_z, r.t_min, 1, rays);
    store4(slabs.per_x, slabs.per_y, slabs.s_near, slabs.s_far, 2, rays);
    store4(slabs.along, r.t_limit, none, none, 3, rays);
  }

  static HWY_INLINE void keep_in_bundle(StreamBundle* b, std::size_t g, const RayLanes& r,
                                        const SlabLanes& slabs) {
    const Rays d;
    const RayInts di;
    const auto put = [&](RV v, float* to) HWY_ATTR { hn::Store(v, d, to + g); };
    put(r.ox, b->ox), put(r.oy, b->oy), put(r.oz, b->oz), put(r.t_limit, b->t_limit);
    put(slabs.shear_x, b->shear_x), put(slabs.shear_y, b->shear_y);
    put(slabs.shear_z, b->shear_z), put(r.t_min, b->t_min);
    put(slabs.per_x, b->per_x), put(slabs.per_y, b->per_y);
    put(slabs.s_near, b->s_near), put(slabs.s_far, b->s_far);
    put(slabs.along, b->along), put(r.t_limit, b->t_low);
    hn::Store(hn::Set(di, kInvalidId), di, b->place + g);
  }

  // Rays that begin far outside the scene (methods/dual/far_ray.h) go down the tree after the
  // others, in a list of their own, so that these do not wait for them.

  HWY_NOINLINE void keep_far(std::uint32_t base, std::uint32_t far) {
    for (; far != 0; far &= far - 1)
      far_.push_back(base + static_cast<std::uint32_t>(__builtin_ctz(far)));
  }

  HWY_NOINLINE void walk_far() {
    RayStream& s = state_.stream;
    std::uint32_t size = 0;
    for (const std::uint32_t n : far_) {
      const Ray& ray = state_.job.rays[s.index[n]];
      const float along = std::fabs(component(ray.direction, s.axis_z));
      const FarRay far = move_origin(long_ray(ray, state_.tree.bounds), ray.t_min, ray.t_max, along,
                                     state_.tree.bounds);
      if (!(far.s_far >= 0)) continue;
      const Vec3 origin = s.along_axes(far.origin);
      StreamRay& r = s.rays[n];
      if (state_.in_bundles) {
        const std::uint32_t bundle = n / kBundleWidth, lane = n % kBundleWidth;
        r = s.bundles[bundle].ray(lane);
        s.bundles[bundle].s_far[lane] = far.s_far;
        s.recorded[bundle] |= 1u << lane;
      }
      r.ox = origin.x, r.oy = origin.y, r.oz = origin.z, r.t_min = far.pad;
      r.s_near = 0, r.s_far = far.s_far, r.start = far.start;
      s.lists[size++] = n;
    }
    far_.clear();
    if (size == 0) return;
    lists_.pad_list(0, size);
    s.are_far = true;
    walk(0, size, false);
    s.are_far = false;
  }

  // Pilots: an occluder of a ray often occludes the neighbouring rays (E. Haines, D. Greenberg,
  // "The Light Buffer", 1986, keep the last occluder). One ray of each sixteen in the list is
  // traced first as the pilot, and the triangles that stopped it and the neighbouring pilots are
  // tested with the sixteen. This is repeated for the next part of the list while it stops most
  // rays. Occlusion rays take 0.99 to 1.08 of the time without pilots. Rays in bundles share so
  // much of the tree that pilots save nothing.

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
    std::uint32_t* const numbers = state_.stream.lists.data();
    std::copy(numbers + first, numbers + alive, numbers + left);
    left += alive - first;
    if (left != 0) lists_.pad_list(0, left);
    return left;
  }

  /// Processes rays [first, end) of the list, and moves those that are left to `left` and
  /// following. Returns the place after them.
  std::uint32_t follow_some(std::uint32_t first, std::uint32_t end, std::uint32_t alive,
                            std::uint32_t left) {
    RayStream& s = state_.stream;
    const std::uint32_t bundles = (end - first) / kBundleWidth, pilots = (alive + 31) / 16 * 16;
    s.grow_lists(pilots + bundles + std::size_t{2} * kBundleWidth);
    for (std::uint32_t b = 0; b < bundles; ++b)
      s.lists[pilots + b] = s.lists[first + b * kBundleWidth + kBundleWidth / 2];
    lists_.pad_list(pilots, bundles);
    walk(pilots, bundles, false);
    places_.assign(bundles + std::size_t{2}, kInvalidId);
    for (std::uint32_t b = 0; b < bundles; ++b) {
      StreamRay& pilot = s.rays[s.lists[first + b * kBundleWidth + kBundleWidth / 2]];
      places_[b + 1] = pilot.place;
      pilot.s_far = -std::numeric_limits<float>::infinity();  // done, whether hit or not
    }
    for (std::uint32_t b = 0; first + b * kBundleWidth < end; ++b) {
      std::uint32_t* const bundle = s.lists.data() + first + b * kBundleWidth;
      const std::uint32_t n = std::min(kBundleWidth, end - first - b * kBundleWidth);
      const std::uint32_t before = places_[b], middle = b < bundles ? places_[b + 1] : before;
      const std::uint32_t after = b < bundles ? places_[b + 2] : before;
      if (middle != kInvalidId) try_on(middle, bundle, n);
      if (before != kInvalidId && before != middle) try_on(before, bundle, n);
      if (after != kInvalidId && after != middle && after != before) try_on(after, bundle, n);
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t number = bundle[i];
        s.lists[left] = number;
        left += s.rays[number].s_far >= s.rays[number].s_near ? 1 : 0;
      }
    }
    return left;
  }

  void try_on(std::uint32_t place, const std::uint32_t* rays, std::uint32_t n) {
    const std::uint32_t used = n == kBundleWidth ? 0xffffu : (1u << n) - 1;
    state_.counts.triangle_tests += n;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes())
      lists_.meet_group(place, 1, rays, used, g);
  }

  StreamState state_;
  Hits hits_;
  Singles singles_{state_, hits_};
  StreamLists<Hits, Singles> lists_{state_, hits_, singles_};
  StreamBundles<Hits, StreamLists<Hits, Singles>> bundles_{state_, hits_, lists_};
  RV along_;                           ///< the largest |d_z| of the stream's rays, in some lane
  std::vector<std::uint32_t> far_;     ///< rays that begin far outside the scene
  std::vector<std::uint32_t> places_;  ///< triangles that the pilots hit, between two invalid ones
};
