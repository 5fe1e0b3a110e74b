// Coherent rays through a scene of two levels: streams of bundles go down the tree over instances
// (methods/dual/stream_walk-inl.h), and where a list of rays reaches an instance, sixteen enter at
// once. In the mesh they go on one by one. Included once for each SIMD target by
// levels/trace_levels_simd.cpp, inside its namespace.

/// The best hits so far are where the caller wants them.
template <class Mode>
class LevelHits : StreamPart {
 public:
  LevelHits(StreamState& state, const LevelJob& job) : StreamPart(state), job_(job) {}

  /// Rays that are filled may have hits of other instances.
  void begin() {
    for (std::uint32_t n = 0; job_.results.go_on && n < stream_.count; ++n) end_at_limit(n);
  }
  void write_back() const {}
  HWY_INLINE void prefetch_ray(std::uint32_t n) const { hwy::Prefetch(stream_.rays.data() + n); }

  [[nodiscard]] const LevelJob& job() const { return job_; }
  [[nodiscard]] HWY_INLINE std::uint32_t number_of(std::uint32_t n) const {
    return stream_.index[n];
  }
  /// Where ray n ends; below 0: nothing can change its result.
  [[nodiscard]] HWY_INLINE float limit_of(std::uint32_t n) const {
    const std::uint32_t number = number_of(n);
    const float t_max = job_.rays[number].t_max;
    if constexpr (Mode::kAny)
      return job_.results.occluded[number] != 0 ? -1 : t_max;
    else
      return std::min(t_max, job_.results.hits[number].t);
  }
  [[nodiscard]] HWY_INLINE Hit best_of(std::uint32_t n) const {
    if constexpr (Mode::kAny)
      return {};
    else
      return job_.results.hits[number_of(n)];
  }
  [[nodiscard]] HWY_INLINE StreamRay record_of(std::uint32_t n) const {
    if (!in_bundles_) {
      StreamRay record = stream_.rays[n];
      if (!stream_.are_far) record.start = 0;
      return record;
    }
    StreamRay record = bundle_of(n).ray(n % kBundleWidth);
    if (!stream_.are_far) return record;
    const float along = record.along;
    record = stream_.rays[n];
    record.along = along;
    return record;
  }
  /// Takes a hit of ray n unless a better one is known.
  HWY_INLINE void take(std::uint32_t n, const Hit& hit) {
    const std::uint32_t number = number_of(n);
    if constexpr (Mode::kAny) {
      job_.results.occluded[number] = 1;
    } else {
      Hit& best = job_.results.hits[number];
      if (!is_before(hit, best)) return;
      best = hit;
    }
    end_at_limit(n);
  }

 private:
  HWY_INLINE void end_at_limit(std::uint32_t n) {
    const float start = stream_.are_far ? stream_.rays[n].start : 0;
    const auto shorten = [&](float along, float* s_far) {
      *s_far = std::min(*s_far, raysheaf::past(limit_of(n), along) - start);
    };
    if (!in_bundles_) return shorten(stream_.rays[n].along, &stream_.rays[n].s_far);
    StreamBundle& b = bundle_of(n);
    const std::uint32_t i = n % kBundleWidth;
    shorten(b.along[i], &b.s_far[i]);
    if ((stream_.recorded[n / kBundleWidth] >> i & 1) != 0) stream_.rays[n].s_far = b.s_far[i];
  }
  [[nodiscard]] HWY_INLINE StreamBundle& bundle_of(std::uint32_t n) const {
    return stream_.bundles[n / kBundleWidth];
  }

  const LevelJob& job_;
};

/// Lists up to this length go down both levels ray by ray. Shorter than through one tree, so that
/// more rays enter together; not fitted.
inline constexpr std::uint32_t kFewRaysAbove = 6;

/// The rays of a stream that share a subtree with few others, and those in meshes.
template <class Mode>
class LevelSingles : StreamPart {
 public:
  static constexpr bool kTwoLevels = true;

  LevelSingles(StreamState& state, LevelHits<Mode>& hits)
      : StreamPart(state), hits_(hits), walk_(hits.job(), nullptr) {
    numbers_.resize_uninitialized(kStreamRays + kBundleWidth);
    pending_.reserve(kMostPending);
  }

  [[nodiscard]] bool is_for_singles(const WaitingList& list) const {
    return list.size <= kFewRaysAbove;
  }
  [[nodiscard]] bool has_many_singles() const { return pending_.size() >= kLeastPending; }

  void add_singles(const WaitingList& list) {
    for (std::uint32_t i = 0; i < list.size; ++i) add_single(stream_.lists[list.offset + i], list);
    if (pending_.size() >= kMostPending) walk_all();
  }

  /// The rays of a list enter the instance of its leaf.
  void enter(const WaitingList& list) {
    const LevelInstance& instance = hits_.job().scene->instances[list.first];
    const Placing& placing = instance.placing;
    if (std::exchange(boxed_, instance.tree) != instance.tree)
      box_ = EnteredBox(instance.tree->bounds);
    std::uint32_t size = list.size;
    const std::uint32_t* rays = stream_.lists.data() + list.offset;
    if (list.in_bundles) {
      const auto* from = reinterpret_cast<const BundleRays*>(rays);
      std::uint32_t* end = numbers_.data();
      for (std::uint32_t i = 0; i < list.size; ++i)
        end = append_lanes(from[i].bundle * kBundleWidth, from[i].rays, end);
      rays = numbers_.data();
      size = static_cast<std::uint32_t>(end - rays);
    }
    counts_.ray_box_tests += size;
    for (std::uint32_t base = 0; base < size; base += kBundleWidth) {
      const std::uint32_t n = std::min(kBundleWidth, size - base);
      alignas(64) std::uint32_t index[kBundleWidth];
      alignas(64) float limits[kBundleWidth];
      for (std::uint32_t i = 0; i < kBundleWidth; ++i) {
        const std::uint32_t ray = rays[base + (i < n ? i : 0)];
        index[i] = stream_.index[ray];
        const bool sees = (instance.mask & hits_.job().choice.mask_of(index[i])) != 0;
        limits[i] = sees ? hits_.limit_of(ray) : -1;
      }
      std::uint32_t met = entered_.enter(job_.rays, index, limits, n, placing, box_);
      for (; met != 0; met &= met - 1) {
        const auto i = static_cast<std::uint32_t>(__builtin_ctz(met));
        const std::uint32_t ray = rays[base + i];
        const StreamRay& record = entered_.records[i];
        if (HWY_LIKELY(std::isfinite(record.along)))
          pending_.push_back(
              {ray, 0, 0, &instance, &kAxesOfQuarters[entered_.quarters[i]], record});
        else  // a direction too long for this: `LevelWalk::enter` has another way
          add_single(ray, list);
      }
    }
    if (pending_.size() >= kLeastPending) walk_all();
  }

  void walk_all() {
    if (pending_.empty()) return;
    walk_.run(View<const PendingWalk>(pending_), stream_, &hits_);
    counts_.add(walk_.take_counts());
    pending_.clear();
  }

 private:
  /// In the tree over instances.
  void add_single(std::uint32_t ray, const WaitingList& list) {
    pending_.push_back({ray, list.first, list.count, nullptr, &stream_, hits_.record_of(ray)});
  }

  LevelHits<Mode>& hits_;
  LevelWalk<Mode> walk_;
  std::vector<PendingWalk> pending_;
  Buffer<std::uint32_t> numbers_;
  EnteredBundle entered_;
  const ObjectTree* boxed_ = nullptr;
  EnteredBox box_;  ///< of that tree
};
