// Traces one bundle through the tree. Included by methods/dual/trace_simd.cpp, inside its
// namespace.

/// With this many lanes or fewer, they continue one by one.
inline constexpr int kSingleRays = 3;

/// Calls `body(first quad, triangles)`.
template <class Body>
HWY_NOINLINE void for_each_leaf(const ObjectTree& tree, const Body& body) {
  for (const BvhNode& node : tree.nodes)
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (node.is_leaf(c)) body(node.first[c], node.count[c]);
}

template <class Mode>
class Walk {
 public:
  explicit Walk(const TraceJob& job)
      : job_(job), tree_(*job.scene.tree), hits_are_chosen_(chooses_hits(job.scene)) {
    waiting_.resize(256);
  }

  void run(const BundleRange& range) {
    Bundle16& p = bundle_;
    first_ = range.first;
    job_.executor->check();
    const DualCounts before = counts_;
    const std::uint32_t lanes = fill_bundle(job_.rays, job_.order + range.first, range.count,
                                            range.quarter, tree_.bounds, &p);
    done_ = 0;
    if (HWY_UNLIKELY(!p.bounded)) {
      for_each_leaf(tree_, [&](std::uint32_t quad, std::uint32_t n) { meet_leaf(quad, n); });
    } else {
      counts_.ray_box_tests += p.count;
      if (lanes != 0) {
        beam_ = make_beam(lanes, p, p.mirrored, p.pad, p.zeta);
        walk_beam();
      }
    }
    write_back();
    if (job_.ray_tests != nullptr) {
      const float share =
          static_cast<float>(counts_.sum() - before.sum()) / static_cast<float>(p.count);
      for (std::uint32_t i = 0; i < p.count; ++i) job_.ray_tests[p.index[i]] += share;
    }
  }

  /// Stores counts and results.
  void finish(const TraceTask& task) {
    if constexpr (Mode::kAll) hand_over_rows(job_, task, rows_);
    const std::lock_guard<std::mutex> lock(*job_.mutex);
    if (job_.counts != nullptr) job_.counts->add(counts_);
  }

 private:
  void walk_beam() {
    std::size_t top = open(0, 0);
    while (top != 0) {
      Waiting next;
      waiting_[--top].copy_to(&next);
      if (next.near() > beam_.end) continue;
      if (next.count() != 0) {
        if (meet_leaf(next.first(), next.count())) beam_.end = farthest_zeta(bundle_) + bundle_.pad;
      } else if (__builtin_popcount(next.lanes()) <= kSingleRays) {
        walk_lanes(next.lanes(), next.first());
        beam_.end = farthest_zeta(bundle_) + bundle_.pad;
      } else {
        top = open(next.first(), top);
      }
    }
  }

  /// Pushes the children that rays intersect on the stack, the nearest on top. The beam's children
  /// are enumerated without unpredictable branches.
  std::size_t open(std::uint32_t number, std::size_t top) {
    if (top + kBvhWidth + 1 > waiting_.size()) waiting_.resize(2 * waiting_.size());
    const BvhNode& node = tree_.nodes[number];
    alignas(64) float near[kBvhWidth];
    counts_.beam_box_tests += node.children;
    std::uint32_t met = children_in_beam(bundle_, beam_, node, near);
    counts_.ray_box_tests += static_cast<std::uint32_t>(__builtin_popcount(met)) * bundle_.count;
    Waiting* const bottom = waiting_.data() + top;
    Waiting* end = bottom;
    for (; met != 0; met &= met - 1) {
      const auto c = static_cast<std::uint32_t>(__builtin_ctz(met));
      const std::uint32_t lanes = rays_in_child(bundle_, node, c);
      Waiting(near[c], lanes, node.first[c], node.count[c]).copy_to(end);
      end += lanes != 0 ? 1 : 0;
    }
    for (Waiting* next = bottom + 1; next < end; ++next) {
      Waiting moved;
      next->copy_to(&moved);
      Waiting* place = next;
      for (; place > bottom && place[-1].near() < moved.near(); --place) place[-1].copy_to(place);
      moved.copy_to(place);
    }
    return static_cast<std::size_t>(end - waiting_.data());
  }

  /// Returns whether any ray now ends earlier.
  bool meet_leaf(std::uint32_t quad, std::uint32_t count) {
    bool shortened = false;
    counts_.triangle_tests += std::uint64_t{count} * bundle_.count;
    for (std::uint32_t done = 0; done < count; done += 4, ++quad) {
      const std::uint32_t used = std::min(4u, count - done);
      for (std::uint32_t k = 0; k < used; ++k)
        triangle_in_bundle(
            bundle_, tree_.quads[quad],
            k, [&](std::size_t g, const Tested<Rays>& tested) __attribute__((always_inline)) {
              shortened |= take_lanes(4 * quad + k, g, tested);
            });
    }
    return shortened;
  }

  HWY_INLINE bool take_lanes(std::uint32_t place, std::size_t g, const Tested<Rays>& tested) {
    const Rays d;
    std::uint32_t hit = bits_of(d, tested.hit);
    std::uint32_t unsettled = bits_of(d, tested.unsettled);
    if ((hit | unsettled) == 0) return false;
    bool shortened = hit != 0;
    if (!Mode::kAll && !hits_are_chosen_) {
      if (hit != 0) unsettled |= take_at_once(place, g, tested);
    } else {
      alignas(64) float low[kBundleWidth], high[kBundleWidth];
      hn::Store(tested.low, d, low);
      hn::Store(tested.high, d, high);
      const std::uint32_t front = bits_of(d, hn::Gt(tested.det, hn::Zero(d)));
      for (; hit != 0; hit &= hit - 1) {
        const auto i = static_cast<std::uint32_t>(__builtin_ctz(hit));
        shortened |= take(static_cast<std::uint32_t>(g) + i, place, {low[i], high[i]},
                          (front >> i & 1) != 0);
      }
    }
    if (unsettled != 0)
      unsettled &= ~lanes_beyond_plane(tree_, bundle_, place, columns_from(bundle_, g));
    for (; unsettled != 0; unsettled &= unsettled - 1)
      shortened |= settle(
          static_cast<std::uint32_t>(g) + static_cast<std::uint32_t>(__builtin_ctz(unsettled)),
          place);
    return shortened;
  }

  /// The usual case of `take_lanes`, in vectors, so that the next load of them does not wait.
  /// Returns the lanes whose best hit cannot be distinguished from this one.
  HWY_INLINE std::uint32_t take_at_once(std::uint32_t place, std::size_t g,
                                        const Tested<Rays>& tested) {
    Bundle16& p = bundle_;
    const Rays d;
    const auto put = [&](RM on, RV value, float* to) {
      hn::Store(hn::IfThenElse(on, value, load(to + g)), d, to + g);
    };
    if constexpr (Mode::kAny) {
      done_ |= bits_of(d, tested.hit) << g;
      put(tested.hit, set(-1), p.t_limit);
      put(tested.hit, set(-std::numeric_limits<float>::infinity()), p.s_far);
      return 0;
    } else {
      const RayInts di;
      const RM nearer = hn::And(tested.hit, hn::Lt(tested.high, load(p.t_low + g)));
      const RV far = past(tested.high, load(p.along + g), p.pad);
      put(nearer, tested.low, p.t_low);
      put(nearer, tested.high, p.t_limit);
      put(nearer, hn::Min(far, load(p.s_far + g)), p.s_far);
      hn::Store(
          hn::IfThenElse(hn::RebindMask(di, nearer), hn::Set(di, place), hn::Load(di, p.place + g)),
          di, p.place + g);
      return bits_of(d, hn::AndNot(nearer, tested.hit));
    }
  }

  /// Settles a lane and a triangle that stage 1 cannot decide. Returns whether the ray now ends
  /// earlier.
  HWY_NOINLINE bool settle(std::uint32_t lane, std::uint32_t place) {
    Bundle16& p = bundle_;
    const Ray& ray = job_.rays[p.index[lane]];
    TriangleHit hit;
    if (!settle_at(tree_, ray, place, p.t_limit[lane], &hit) || !is_shown(lane, place, hit.front))
      return false;
    if constexpr (Mode::kAll || Mode::kAny) {
      return keep(lane, place);
    } else {
      const BestHit best{&p.t_low[lane], &p.t_limit[lane], &p.place[lane]};
      if (!best.take_settled(tree_, ray, place, hit.t)) return false;
      shorten(lane);
      return true;
    }
  }

  /// Takes a hit of a lane within its limits. Returns whether the ray now ends earlier.
  bool take(std::uint32_t lane, std::uint32_t place, Interval t, bool front) {
    Bundle16& p = bundle_;
    if (!is_shown(lane, place, front)) return false;
    if constexpr (Mode::kAll || Mode::kAny) {
      return keep(lane, place);
    } else {
      if (!(t.high < p.t_low[lane])) return t.low <= p.t_limit[lane] && settle(lane, place);
      p.t_low[lane] = t.low;
      p.t_limit[lane] = t.high;
      p.place[lane] = place;
      shorten(lane);
      return true;
    }
  }

  [[nodiscard]] bool is_shown(std::uint32_t lane, std::uint32_t place, bool front) const {
    return !hits_are_chosen_ ||
           counts_as_hit(job_.scene, bundle_.index[lane], id_at(tree_, place), front);
  }

  /// Takes a hit whose distance does not matter. Returns whether the ray now ends earlier.
  bool keep(std::uint32_t lane, std::uint32_t place) {
    Bundle16& p = bundle_;
    if constexpr (Mode::kAll) {
      if (lane >= p.count) return false;
      if (job_.hit_counts != nullptr)
        ++job_.hit_counts[p.index[lane]];
      else
        rows_.push_back({first_ + lane, {0, 0, 0, place}});
      return false;
    } else {
      done_ |= 1u << lane;
      p.t_limit[lane] = -1;
      p.s_far[lane] = -std::numeric_limits<float>::infinity();
      return true;
    }
  }

  void shorten(std::uint32_t lane) {
    Bundle16& p = bundle_;
    p.s_far[lane] = std::min(p.s_far[lane], raysheaf::past(p.t_limit[lane], p.along[lane], p.pad));
  }

  /// Copies lane `lane` to the record `rays_[i]`.
  void keep_lane(std::uint32_t lane, std::size_t i) {
    const Bundle16& p = bundle_;
    rays_[i] = {p.ox[lane],      p.oy[lane],      p.oz[lane],      p.t_limit[lane],
                p.shear_x[lane], p.shear_y[lane], p.shear_z[lane], p.t_min[lane],
                p.per_x[lane],   p.per_y[lane],   p.s_near[lane],  p.s_far[lane]};
  }

  void walk_lanes(std::uint32_t lanes, std::uint32_t root) {
    const SharedAxes axes(bundle_);
    walk_singles<!Mode::kAll>(
        tree_, axes, &singles_, kSingleRays,
        [&](std::uint32_t i) {
          if (lanes == 0) return false;
          singles_.number[i] = static_cast<std::uint32_t>(__builtin_ctz(lanes));
          keep_lane(singles_.number[i], i);
          singles_.ray[i] = &rays_[i];
          singles_.start(i, root, 0);
          lanes &= lanes - 1;
          return true;
        },
        [&](std::uint32_t i, std::uint32_t place, Interval t, bool front) {
          take(singles_.number[i], place, t, front);
          tell_record(i);
        },
        [&](std::uint32_t i, std::uint32_t place) {
          settle(singles_.number[i], place);
          tell_record(i);
        },
        &counts_);
  }

  /// Copies the limits of its lane to the record of walk `i`.
  void tell_record(std::uint32_t i) {
    rays_[i].s_far = bundle_.s_far[singles_.number[i]];
    rays_[i].t_limit = bundle_.t_limit[singles_.number[i]];
  }

  void write_back() {
    const Bundle16& p = bundle_;
    if constexpr (Mode::kAny) {
      for (std::uint32_t i = 0; i < p.count; ++i) job_.occluded[p.index[i]] = done_ >> i & 1;
    } else if constexpr (!Mode::kAll) {
      alignas(64) IndexedHit hits[kBundleWidth];
      values_.fill(tree_, job_.rays, p.index, p.place);
      values_.store(tree_, hits);
      for (std::uint32_t i = 0; i < p.count; ++i) job_.hits[p.index[i]] = hits[i];
    }
  }

  const TraceJob& job_;
  const ObjectTree& tree_;
  const bool hits_are_chosen_;  ///< not all hits count
  Bundle16 bundle_;
  Beam beam_;
  std::uint32_t done_ = 0;
  DualCounts counts_;
  std::vector<Waiting> waiting_;
  SingleWalks singles_;
  StreamRay rays_[kSingleRays];  ///< of the lanes that continue one by one
  std::uint32_t first_ = 0;      ///< the bundle's place in the order
  HitValues values_;
  std::vector<RowHit> rows_;  ///< with places of triangles
};
