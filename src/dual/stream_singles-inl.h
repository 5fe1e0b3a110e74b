// Rays of a stream that nobody shares a subtree with any longer: they wait until there are enough
// of them, and then take turns. Included once a SIMD target by dual/trace_simd.cpp, inside its
// namespace.

/// Lists as long or shorter go on ray by ray: in a tree that the caches hold, and in one that they
/// do not, where rays that take turns hide each other's waiting.
inline constexpr std::uint32_t kFewRays = 8, kFewRaysFarFromCache = 32;
inline constexpr std::size_t kCachedTreeBytes = std::size_t{16} << 20;
/// Rays that take turns, and those that wait to. More of them leave fewer turns empty; but what
/// comes after them in the stream cannot know yet what they will hit.
inline constexpr std::uint32_t kSingleWalks = 16;
inline constexpr std::size_t kLeastPending = 64, kMostPending = 256;

struct PendingRay {
  std::uint32_t ray, root;
};

template <class Mode>
class StreamSingles : protected StreamHits<Mode> {
 protected:
  using StreamHits<Mode>::tree_, StreamHits<Mode>::stream_, StreamHits<Mode>::counts_;

  explicit StreamSingles(const TraceJob& job)
      : StreamHits<Mode>(job),
        few_(tree_.nodes.size() * sizeof(BvhNode) + tree_.quads.size() * sizeof(TriangleQuad) >
                     kCachedTreeBytes
                 ? kFewRaysFarFromCache
                 : kFewRays) {}

  [[nodiscard]] bool is_for_singles(const WaitingList& list) const {
    return list.count == 0 && list.size <= few_;
  }
  [[nodiscard]] bool has_many_singles() const { return pending_.size() >= kLeastPending; }

  void add_singles(const WaitingList& list) {
    if (pending_.size() + list.size > kMostPending) walk_singles_of_stream();
    for (std::uint32_t i = 0; i < list.size; ++i)
      pending_.push_back({stream_.lists[list.offset + i], list.first});
  }

  void walk_singles_of_stream() {
    if (pending_.empty()) return;
    const PendingRay* next = pending_.data();
    const PendingRay* const end = next + pending_.size();
    counts_.ray_box_tests += walk_singles(
        tree_, singles_, kSingleWalks,
        [&](SingleWalk* walk) {
          // Those that were hit since are done, or see no farther.
          while (next != end && stream_.rays[next->ray].s_far < stream_.rays[next->ray].s_near)
            ++next;
          if (next == end) return false;
          walk->number = next->ray;
          walk->ray = single(walk->number);
          walk->s_far = &stream_.rays[walk->number].s_far;
          walk->start(next->root);
          ++next;
          return true;
        },
        [&](const SingleWalk& walk, std::uint32_t quad, std::uint32_t count) {
          counts_.triangle_tests += count;
          leaf_with_ray(
              tree_, walk.ray, stream_.shears[walk.number].t_limit, quad, count,
              [&](std::uint32_t place, const TriangleHit& hit) { take(walk.number, place, hit); });
        });
    pending_.clear();
  }

 private:
  using StreamHits<Mode>::take;

  SingleRay single(std::uint32_t n) const {
    const Stream& s = stream_;
    const StreamRay& r = s.rays[n];
    const StreamShear& shear = s.shears[n];
    // A lower plane moves down by the pad as the origin moves up, an upper plane up.
    const auto from = [&](float o, int row) { return row < 3 ? o + s.pad : o - s.pad; };
    return {from(r.ox, s.near_x),
            from(r.ox, s.far_x),
            from(r.oy, s.near_y),
            from(r.oy, s.far_y),
            from(r.oz, s.near_z),
            from(r.oz, s.far_z),
            r.per_x,
            r.per_y,
            r.s_near,
            s.near_x,
            s.far_x,
            s.near_y,
            s.far_y,
            s.near_z,
            s.far_z,
            r.ox,
            r.oy,
            r.oz,
            shear.shear_x,
            shear.shear_y,
            shear.shear_z,
            shear.t_min,
            s.axis_x,
            s.axis_y,
            s.axis_z,
            s.mirrored};
  }

  const std::uint32_t few_;
  SingleWalk singles_[kSingleWalks];
  std::vector<PendingRay> pending_;
};
