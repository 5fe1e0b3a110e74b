// Few rays, too few for streams: each by itself, towards any quarter, interleaved
// (methods/dual/single-inl.h). Nothing is allocated, so that a call with one ray costs little more
// than its way down the tree. Included once for each SIMD target by methods/dual/trace_simd.cpp,
// inside its namespace.

template <class Mode>
class FewWalk : public RayHits<Mode, FewWalk<Mode>> {
  using Base = RayHits<Mode, FewWalk<Mode>>;
  friend Base;

 public:
  explicit FewWalk(const TraceJob& job)
      : Base(job),
        job_(job),
        tree_(*job.scene.tree),
        subtrees_(tree_),
        growth_(tree_.bounds),
        far_(kFarLengths * max_component(tree_.bounds.max - tree_.bounds.min)) {
    for (int axis = 0; axis < 3; ++axis) {
      const float low = component(tree_.bounds.min, axis), high = component(tree_.bounds.max, axis);
      plane_[axis] = low, plane_[3 + axis] = high;
      grown_[axis] = low - growth_.of(low), grown_[3 + axis] = high + growth_.of(high);
    }
  }

  DualCounts run(std::uint32_t count) {
    std::fill_n(places_, div_ceil(count, kBundleWidth) * kBundleWidth, kInvalidId);
    walk(count);
    if (HWY_UNLIKELY(far_count_ != 0)) {
      are_far_ = true;
      walk(far_count_);
    }
    if constexpr (Mode::kAny) {
      for (std::uint32_t n = 0; n < count; ++n)
        job_.results.occluded.data[n] = places_[n] != kInvalidId ? 1 : 0;
    } else {
      write_back(count);
    }
    return counts_;
  }

  // For `walk_singles`.
  static constexpr bool kTwoLevels = false;
  [[nodiscard]] HWY_INLINE const BvhNode& node(std::uint32_t /*walk*/, std::uint32_t number) const {
    return tree_.nodes[number];
  }
  [[nodiscard]] HWY_INLINE const TriangleQuad& quad(std::uint32_t /*walk*/,
                                                    std::uint32_t number) const {
    return tree_.quads[number];
  }
  [[nodiscard]] HWY_INLINE const QuarterAxes& axes(std::uint32_t i) const { return *axes_[i]; }
  [[nodiscard]] HWY_INLINE const Subtrees& subtrees(std::uint32_t /*walk*/) const {
    return subtrees_;
  }
  [[nodiscard]] HWY_INLINE bool are_far() const { return are_far_; }

 private:
  using OneLane = hn::CappedTag<float, 1>;

  /// Traces the far rays, or all others.
  void walk(std::uint32_t count) {
    std::uint32_t next = 0;
    walk_singles<true>(
        *this, &walks_, std::min(count, SingleWalks::kMost),
        [&](std::uint32_t i) {
          while (next != count) {
            const std::uint32_t n = next++;
            if (start(i, are_far_ ? far_rays_[n] : n)) return true;
          }
          return false;
        },
        [&](std::uint32_t i, std::uint32_t place, Interval t, bool front) {
          this->take(i, place, t, front);
        },
        [&](std::uint32_t i, std::uint32_t place) { this->settle(i, place); }, &counts_);
  }

  /// Starts ray n at the root as walk i; returns whether it meets the scene's box. Rays that begin
  /// far outside the scene are put off.
  HWY_INLINE bool start(std::uint32_t i, std::uint32_t n) {
    job_.executor.check();
    const Ray& ray = job_.rays[n];
    if (!are_far_ && distance_outside(ray.origin, tree_.bounds) > far_) {
      far_rays_[far_count_++] = n;
      return false;
    }
    ++counts_.ray_box_tests;
    const QuarterAxes& axes = kAxesOfQuarters[quarter_of(ray.direction)];
    const OneLane d;
    const auto all = [&](float x) HWY_ATTR { return hn::Set(d, x); };
    Vec3 o = axes.along_axes(ray.origin);
    const Vec3 to = axes.along_axes(ray.direction);
    SlabLanesOf<OneLane> slabs({all(o.x), all(o.y), all(o.z), all(to.x), all(to.y), all(to.z),
                                all(ray.t_min), all(ray.t_max)},
                               axes.mirrored);
    float t_min = ray.t_min, begin = 0;
    if (HWY_UNLIKELY(are_far_)) {
      const FarRay far = move_origin(long_ray(ray, tree_.bounds), ray.t_min, ray.t_max,
                                     std::fabs(to.z), tree_.bounds);
      if (!(far.s_far >= 0)) return false;
      o = axes.along_axes(far.origin);
      t_min = far.pad, begin = far.start;
      slabs.s_near = all(0), slabs.s_far = all(far.s_far);
    } else {
      const SeenBox seen{grown_[axes.near_x], grown_[axes.far_x],  grown_[axes.near_y],
                         grown_[axes.far_y],  plane_[axes.near_z], plane_[axes.far_z]};
      const BoxFromOriginsOf<OneLane> box(seen, all(o.x), all(o.y), all(o.z));
      if (hn::AllFalse(d, slabs.clip(box, axes.mirrored))) return false;
    }
    const auto of = [](hn::Vec<OneLane> v) HWY_ATTR { return hn::GetLane(v); };
    StreamRay& r = records_[i];
    r.ox = o.x, r.oy = o.y, r.oz = o.z, r.t_limit = ray.t_max;
    r.shear_x = of(slabs.shear_x), r.shear_y = of(slabs.shear_y), r.shear_z = of(slabs.shear_z);
    r.t_min = t_min;
    r.per_x = of(slabs.per_x), r.per_y = of(slabs.per_y);
    r.s_near = of(slabs.s_near), r.s_far = of(slabs.s_far);
    r.along = of(slabs.along), r.t_low = ray.t_max, r.start = begin;
    Growth growth = growth_;
    growth.include(r.along);
    axes_[i] = &axes;
    walks_.ray[i] = &r;
    walks_.number[i] = n;
    walks_.slabs[i] = SingleSlabs(r, axes, growth, are_far_ ? t_min : 0);
    walks_.start(i, 0, 0);
    return true;
  }

  // For `RayHits`.
  [[nodiscard]] HWY_INLINE RayLimits limits_of(std::uint32_t i) {
    StreamRay& r = records_[i];
    return {{&r.t_low, &r.t_limit, &places_[walks_.number[i]]}, &r.s_far, r.along, r.start};
  }
  [[nodiscard]] HWY_INLINE std::uint32_t number_of(std::uint32_t i) const {
    return walks_.number[i];
  }
  [[nodiscard]] HWY_INLINE const QuarterAxes& axes_of(std::uint32_t i) const { return *axes_[i]; }
  [[nodiscard]] HWY_INLINE SlopedRay sloped(std::uint32_t i) const {
    return sloped_ray(records_[i], *axes_[i], are_far_, job_.rays[walks_.number[i]]);
  }
  HWY_INLINE void ends(std::uint32_t /*i*/) const {}

  void write_back(std::uint32_t count) const {
    constexpr std::uint32_t kLeastInLanes = 4;
    if (count < kLeastInLanes) {
      for (std::uint32_t n = 0; n < count; ++n) job_.results.hits.data[n] = hit_of(n);
      return;
    }
    HitValues values;
    alignas(64) std::uint32_t numbers[kBundleWidth];
    alignas(64) IndexedHit hits[kBundleWidth];
    for (std::uint32_t first = 0; first < count; first += kBundleWidth) {
      const std::uint32_t here = std::min(kBundleWidth, count - first);
      for (std::uint32_t i = 0; i < kBundleWidth; ++i) numbers[i] = first + (i < here ? i : 0);
      values.fill(tree_, job_.rays, numbers, places_ + first, here);
      values.store(hits);
      std::copy_n(hits, here, job_.results.hits.data + first);
    }
  }

  [[nodiscard]] IndexedHit hit_of(std::uint32_t n) const {
    if (places_[n] == kInvalidId) return {};
    const PlacedCorners p(tree_, places_[n]);
    const Ray& ray = job_.rays[n];
    const TriangleHit hit = values_of_hit(ray.origin, ray.direction, p.a, p.b, p.c);
    return {hit.t, hit.u, hit.v, id_at(tree_, places_[n])};
  }

  const TraceJob& job_;
  const ObjectTree& tree_;
  const Subtrees subtrees_;
  const Growth growth_;
  const float far_;            ///< rays farther outside the scene are far
  float plane_[6], grown_[6];  ///< of the scene's box, and moved outwards; rows as in BvhNode
  StreamRay records_[SingleWalks::kMost];        ///< of each walk
  const QuarterAxes* axes_[SingleWalks::kMost];  ///< of each walk
  SingleWalks walks_;
  alignas(64) std::uint32_t places_[kFewTogether];  ///< of each ray's best hit, or kInvalidId
  std::uint32_t far_rays_[kFewTogether], far_count_ = 0;
  bool are_far_ = false;  ///< the rays on their way now
  DualCounts counts_;
};
static_assert(kFewTogether % kBundleWidth == 0);
