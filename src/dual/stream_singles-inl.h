// Rays of a stream that nobody shares a subtree with any longer: they wait until there are enough
// of them, and then take turns. Included once a SIMD target by dual/trace_simd.cpp, inside its
// namespace.

/// Lists as long or shorter go on ray by ray: in a tree that the caches hold, and in one that they
/// do not, where rays that take turns hide each other's waiting.
inline constexpr std::uint32_t kFewRays = 8, kFewRaysFarFromCache = 32;
/// The same of lists at a leaf.
inline constexpr std::uint32_t kFewRaysAtLeaf = 2;
inline constexpr std::size_t kCachedTreeBytes = std::size_t{16} << 20;
/// Rays that take turns, and those that wait to. More of them leave fewer turns empty; but what
/// comes after them in the stream cannot know yet what they will hit.
inline constexpr std::uint32_t kSingleWalks = 16;
inline constexpr std::size_t kLeastPending = 64, kMostPending = 256;

struct PendingRay {
  std::uint32_t ray, first, count;  ///< where it goes on, as in BvhNode
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
    return list.size <= (list.count == 0 ? few_ : kFewRaysAtLeaf);
  }
  [[nodiscard]] bool has_many_singles() const { return pending_.size() >= kLeastPending; }

  void add_singles(const WaitingList& list) {
    if (pending_.size() + list.size > kMostPending) walk_singles_of_stream();
    for (std::uint32_t i = 0; i < list.size; ++i)
      pending_.push_back({stream_.lists[list.offset + i], list.first, list.count});
  }

  void walk_singles_of_stream() {
    if (pending_.empty()) return;
    const SharedAxes axes(stream_);
    const PendingRay* next = pending_.data();
    const PendingRay* const end = next + pending_.size();
    counts_.ray_box_tests += walk_singles(
        tree_, axes, singles_, kSingleWalks,
        [&](SingleWalk* walk) {
          // Those that were hit since are done, or see no farther.
          while (next != end && stream_.rays[next->ray].s_far < stream_.rays[next->ray].s_near)
            ++next;
          if (next == end) return false;
          walk->number = next->ray;
          walk->ray = &stream_.rays[next->ray];
          walk->shear = &stream_.shears[next->ray];
          walk->start(next->first, next->count);
          ++next;
          return true;
        },
        [&](const SingleWalk& walk) {
          counts_.triangle_tests += walk.count;
          leaf_with_ray(
              tree_, axes, *walk.ray, *walk.shear, walk.first, walk.count,
              [&](std::uint32_t place, const TriangleHit& hit) { take(walk.number, place, hit); });
        });
    pending_.clear();
  }

 private:
  using StreamHits<Mode>::take;

  const std::uint32_t few_;
  SingleWalk singles_[kSingleWalks];
  std::vector<PendingRay> pending_;
};
