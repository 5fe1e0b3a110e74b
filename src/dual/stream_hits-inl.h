// What a stream keeps of the hits it meets. Included once a SIMD target by dual/trace_simd.cpp,
// inside its namespace.

/// Hits go back to rays that stand far apart.
inline constexpr std::uint32_t kWritesAhead = 24;

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
    alignas(64) float t[kPacketWidth], u[kPacketWidth], v[kPacketWidth];
    hn::Store(tested.t, d, t);
    hn::Store(hn::Div(tested.v, tested.det), d, u);
    hn::Store(hn::Div(tested.w, tested.det), d, v);
    const std::uint32_t front = bits_of(d, hn::Gt(tested.det, hn::Zero(d)));
    for (; hit != 0; hit &= hit - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(hit));
      take(number(i), place, {t[i], u[i], v[i], (front >> i & 1) != 0});
    }
    for (; unsettled != 0; unsettled &= unsettled - 1)
      take_exactly(number(static_cast<std::uint32_t>(__builtin_ctz(unsettled))), place);
  }

  HWY_NOINLINE void take_lanes(std::uint32_t place, const std::uint32_t* block, std::uint32_t used,
                               std::size_t g, const Tested<Rays>& tested) {
    const std::uint32_t hit = bits_of(Rays(), tested.hit) & used >> g;
    const std::uint32_t unsettled = bits_of(Rays(), tested.unsettled) & used >> g;
    if ((hit | unsettled) == 0) return;
    take_each(place, hit, unsettled, tested, [&](std::uint32_t i) { return block[g + i]; });
  }

  /// The same for rays of a block, all at once.
  HWY_NOINLINE void take_in_block(std::uint32_t place, BlockRays rays, std::size_t g,
                                  const Tested<Rays>& tested) {
    const Rays d;
    const std::uint32_t used = std::uint32_t{rays.rays} >> g;
    const std::uint32_t hit = bits_of(d, tested.hit) & used;
    const std::uint32_t unsettled = bits_of(d, tested.unsettled) & used;
    if ((hit | unsettled) == 0) return;
    const auto first = static_cast<std::uint32_t>(rays.block * kPacketWidth + g);
    const auto number = [first](std::uint32_t i) { return first + i; };
    if (Mode::kAll || one_side_) return take_each(place, hit, unsettled, tested, number);
    StreamBlock& b = stream_.blocks[rays.block];
    const RayInts di;
    const RV best = load(b.t_limit + g), far = load(b.s_far + g);
    const auto triangle = hn::Load(di, b.triangle + g);
    RV t, end;
    RM nearer = lanes_of(hit, 0);
    hn::Vec<RayInts> met;
    if constexpr (Mode::kAny) {
      // The least of a leaf's, whatever order a SIMD target finds them in.
      met = hn::Min(triangle, hn::Set(di, place));
      t = set(-1);
      end = set(-std::numeric_limits<float>::infinity());
    } else {
      met = hn::Set(di, id_at(tree_, place));
      t = tested.t;
      const RM first_of_two = hn::And(hn::Eq(t, best), hn::RebindMask(d, hn::Lt(met, triangle)));
      nearer = hn::And(nearer, hn::Or(hn::Lt(t, best), first_of_two));
      end = hn::Min(past(t, load(b.along + g), stream_.pad), far);
      hn::Store(hn::IfThenElse(nearer, hn::Div(tested.v, tested.det), load(b.u + g)), d, b.u + g);
      hn::Store(hn::IfThenElse(nearer, hn::Div(tested.w, tested.det), load(b.v + g)), d, b.v + g);
    }
    hn::Store(hn::IfThenElse(nearer, t, best), d, b.t_limit + g);
    hn::Store(hn::IfThenElse(nearer, end, far), d, b.s_far + g);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, nearer), met, triangle), di, b.triangle + g);
    for (std::uint32_t turn = bits_of(d, nearer) & stream_.recorded[rays.block] >> g; turn != 0;
         turn &= turn - 1)
      tell_record(number(static_cast<std::uint32_t>(__builtin_ctz(turn))));
    for (std::uint32_t turn = unsettled; turn != 0; turn &= turn - 1)
      take_exactly(number(static_cast<std::uint32_t>(__builtin_ctz(turn))), place);
  }

  HWY_NOINLINE void take_exactly(std::uint32_t n, std::uint32_t place) {
    const StreamRay ray = in_blocks_ ? block_of(n).ray(n % kPacketWidth) : stream_.rays[n];
    TriangleHit hit;
    if (settle_for_ray(SharedAxes(stream_), ray, tree_.quads[place / 4],
                       static_cast<int>(place % 4), &hit))
      take(n, place, hit);
  }

  void take(std::uint32_t n, std::uint32_t place, const TriangleHit& hit) {
    Stream& s = stream_;
    const std::uint32_t id = id_at(tree_, place);
    if (one_side_ && !shows(job_.scene.facing, job_.scene.flags[id], hit.front)) return;
    if constexpr (Mode::kAll) {
      if (job_.hit_counts != nullptr)
        ++job_.hit_counts[s.index[n]];
      else
        s.rows.push_back({s.first + n, {hit.t, hit.u, hit.v, id}});
    } else if (in_blocks_) {
      StreamBlock& b = block_of(n);
      const std::uint32_t i = n % kPacketWidth;
      if (improve(hit, place, id, b.along[i], &b.t_limit[i], &b.s_far[i], &b.u[i], &b.v[i],
                  &b.triangle[i]))
        tell_record(n);
    } else {
      StreamRay& r = s.rays[n];
      improve(hit, place, id, r.along, &r.t_limit, &r.s_far, &r.u, &r.v, &r.triangle);
    }
  }

  HWY_INLINE void prefetch_ray(std::uint32_t n) const { hwy::Prefetch(stream_.rays.data() + n); }

  void write_back() {
    if constexpr (!Mode::kAll) in_blocks_ ? write_back_blocks() : write_back_rays();
  }

  const TraceJob& job_;
  const ObjectTree& tree_;
  const bool in_blocks_;  ///< neighbours are expected to stay together for a while
  const bool one_side_;   ///< hits of some triangles' other side do not count
  std::unique_ptr<Stream> own_;
  Stream& stream_;
  DualCounts counts_;

 private:
  [[nodiscard]] HWY_INLINE StreamBlock& block_of(std::uint32_t n) const {
    return stream_.blocks[n / kPacketWidth];
  }

  /// A ray's record learns how far it looks.
  HWY_INLINE void tell_record(std::uint32_t n) {
    const StreamBlock& b = block_of(n);
    stream_.rays[n].t_limit = b.t_limit[n % kPacketWidth];
    stream_.rays[n].s_far = b.s_far[n % kPacketWidth];
  }

  /// Whether the hit is the ray's best so far, which is then kept.
  HWY_INLINE bool improve(const TriangleHit& hit, std::uint32_t place, std::uint32_t id,
                          float along, float* t_limit, float* s_far, float* u, float* v,
                          std::uint32_t* triangle) const {
    if constexpr (Mode::kAny) {
      // The least of a leaf's, whatever order a SIMD target finds them in.
      *triangle = std::min(*triangle, place);
      *t_limit = -1;
      *s_far = -std::numeric_limits<float>::infinity();
    } else {
      // The limit is the best so far, and at hand.
      if (!(hit.t < *t_limit || (hit.t == *t_limit && id < *triangle))) return false;
      *t_limit = hit.t;
      *u = hit.u;
      *v = hit.v;
      *triangle = id;
      *s_far = std::min(*s_far, raysheaf::past(hit.t, along, stream_.pad));
    }
    return true;
  }

  [[nodiscard]] static HWY_INLINE RV past(RV t, RV along, float pad) {
    return hn::Add(hn::Mul(hn::Mul(hn::Add(t, set(kLeastStep)), along), set(1 + 8 * kUnitRoundoff)),
                   set(pad));
  }

  void write_back_rays() {
    const Stream& s = stream_;
    for (std::uint32_t i = 0; i < s.count; ++i) {
      if constexpr (Mode::kAny) {
        job_.occluded[s.index[i]] = s.rays[i].triangle != kInvalidId ? 1 : 0;
      } else {
        if (i + kWritesAhead < s.count)
          __builtin_prefetch(job_.hits + s.index[i + kWritesAhead], 1);
        const StreamRay& ray = s.rays[i];
        const float t = ray.triangle != kInvalidId ? ray.t_limit : EngineHit().t;
        job_.hits[s.index[i]] = {t, ray.u, ray.v, ray.triangle};
      }
    }
  }

  void write_back_blocks() {
    const Stream& s = stream_;
    const Rays d;
    const RayInts di;
    const auto none = hn::Set(di, kInvalidId);
    for (std::uint32_t base = 0; base < s.count; base += kPacketWidth) {
      const StreamBlock& b = s.blocks[base / kPacketWidth];
      const std::uint32_t n = std::min(kPacketWidth, s.count - base);
      const std::uint32_t* const index = s.index.data() + base;
      if constexpr (Mode::kAny) {
        for (std::uint32_t i = 0; i < n; ++i)
          job_.occluded[index[i]] = b.triangle[i] != kInvalidId ? 1 : 0;
      } else {
        alignas(64) EngineHit hits[kPacketWidth];
        for (std::size_t g = 0; g < kPacketWidth; g += ray_lanes()) {
          const auto id = hn::Load(di, b.triangle + g);
          const RV t = hn::IfThenElse(hn::RebindMask(d, hn::Eq(id, none)), set(EngineHit().t),
                                      load(b.t_limit + g));
          store4(t, load(b.u + g), load(b.v + g), hn::BitCast(d, id), 0, hits + g);
        }
        for (std::uint32_t i = 0; i < n; ++i) job_.hits[index[i]] = hits[i];
      }
    }
  }
};
