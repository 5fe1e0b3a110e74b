// Rays of a stream that nobody shares a subtree with any longer: they wait until there are enough
// of them, and then take turns. Included once a SIMD target by methods/dual/trace_simd.cpp, inside
// its namespace.

/// Lists as long or shorter go on ray by ray.
inline constexpr std::uint32_t kFewRays = 24;
/// The same of lists at a leaf.
inline constexpr std::uint32_t kFewRaysAtLeaf = 2;
/// Rays that take turns, and those that wait to. More of them leave fewer turns empty; but what
/// comes after them in the stream cannot know yet what they will hit.
inline constexpr std::uint32_t kSingleWalks = SingleWalks::kMost;
inline constexpr std::size_t kLeastPending = 64, kMostPending = 256;

struct PendingRay {
  std::uint32_t ray, first, count;  ///< where it goes on, as in BvhNode
};

template <class Mode>
class StreamSingles : protected StreamHits<Mode> {
 protected:
  using StreamHits<Mode>::tree_, StreamHits<Mode>::stream_, StreamHits<Mode>::counts_;
  using StreamHits<Mode>::prefetch_ray, StreamHits<Mode>::take, StreamHits<Mode>::settle;

  explicit StreamSingles(const TraceJob& job) : StreamHits<Mode>(job) {}

  [[nodiscard]] bool is_for_singles(const WaitingList& list) const {
    return list.size <= (list.count == 0 ? kFewRays : kFewRaysAtLeaf);
  }
  [[nodiscard]] bool has_many_singles() const { return pending_.size() >= kLeastPending; }

  void add_singles(const WaitingList& list) {
    if (pending_.size() + list.size > kMostPending) walk_singles_of_stream();
    for (std::uint32_t i = 0; i < list.size; ++i) {
      const std::uint32_t ray = stream_.lists[list.offset + i];
      prefetch_ray(ray);
      pending_.push_back({ray, list.first, list.count});
    }
  }

  void walk_singles_of_stream() {
    if (pending_.empty()) return;
    const SharedAxes axes(stream_);
    const PendingRay* next = pending_.data();
    const PendingRay* const end = next + pending_.size();
    walk_singles<!Mode::kAll>(
        tree_, axes, &singles_, kSingleWalks,
        [&](std::uint32_t i) {
          // Those that were hit since are done, or see no farther.
          while (next != end && stream_.rays[next->ray].s_far < stream_.rays[next->ray].s_near)
            ++next;
          if (next == end) return false;
          this->job_.executor->check();
          singles_.number[i] = next->ray;
          singles_.ray[i] = &stream_.rays[next->ray];
          singles_.start(i, next->first, next->count);
          ++next;
          return true;
        },
        [&](std::uint32_t i, std::uint32_t place, Interval t, bool front) {
          take(singles_.number[i], place, t, front);
        },
        [&](std::uint32_t i, std::uint32_t place) { settle(singles_.number[i], place); }, &counts_);
    pending_.clear();
  }

 private:
  SingleWalks singles_;
  std::vector<PendingRay> pending_;
};
