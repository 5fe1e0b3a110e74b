// What rays that go on alone share, and where each of them is. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

/// What the rays of a bundle or of a stream share.
struct SharedAxes {
  int axis_x, axis_y, axis_z;
  int near_x, far_x, near_y, far_y, near_z, far_z;
  float pad_x, pad_y, pad_z;  ///< added to an origin for near planes, taken from it for far ones
  float per_z;

  /// `Bundle`: RayBundle or RayStream.
  template <class Bundle>
  explicit SharedAxes(const Bundle& b)
      : axis_x(b.axis_x),
        axis_y(b.axis_y),
        axis_z(b.axis_z),
        near_x(b.near_x),
        far_x(b.far_x),
        near_y(b.near_y),
        far_y(b.far_y),
        near_z(b.near_z),
        far_z(b.far_z),
        // A lower plane moves down by the pad as the origin moves up, an upper plane up.
        pad_x(b.near_x < 3 ? b.pad : -b.pad),
        pad_y(b.near_y < 3 ? b.pad : -b.pad),
        pad_z(b.near_z < 3 ? b.pad : -b.pad),
        per_z(b.mirrored ? -1.0f : 1.0f) {}
};

/// Rays on their way through subtrees, side by side: walk i goes on at `first[i]`, and what waits
/// for it is on its stack, the nearest on top.
struct SingleWalks {
  static constexpr std::uint32_t kMost = 16;

  const StreamRay* ray[kMost];
  std::uint32_t number[kMost];  ///< the caller's name for the ray
  alignas(64) std::uint32_t first[kMost] = {}, count[kMost] = {};  ///< next, as in BvhNode
  alignas(64) std::uint32_t top[kMost] = {};                       ///< how many wait

  void start(std::uint32_t i, std::uint32_t begin, std::uint32_t triangles) {
    first[i] = begin;
    count[i] = triangles;
    top[i] = 0;
  }
  [[nodiscard]] float* nears(std::uint32_t i) { return nears_.data() + std::size_t{i} * room_; }
  [[nodiscard]] std::uint32_t* firsts(std::uint32_t i) {
    return firsts_.data() + std::size_t{i} * room_;
  }
  [[nodiscard]] std::uint32_t* counts(std::uint32_t i) {
    return counts_.data() + std::size_t{i} * room_;
  }
  [[nodiscard]] bool has_room(std::uint32_t i) const { return top[i] + kBvhWidth <= room_; }
  void grow() {
    const auto spread = [this](auto* stacks) {
      stacks->resize(2 * stacks->size());
      for (std::uint32_t i = kMost; --i > 0;)
        std::copy_n(stacks->data() + i * room_, room_, stacks->data() + 2 * i * room_);
    };
    spread(&nears_);
    spread(&firsts_);
    spread(&counts_);
    room_ *= 2;
  }
  void pop(std::uint32_t i) {
    const std::uint32_t last = --top[i];
    first[i] = firsts(i)[last];
    count[i] = counts(i)[last];
  }
  /// Without what the ray no longer reaches, in the same order.
  void drop_beyond(std::uint32_t i, float s_far) {
    float* const near = nears(i);
    std::uint32_t* const next = firsts(i);
    std::uint32_t* const triangles = counts(i);
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < top[i]; ++k) {
      near[kept] = near[k];
      next[kept] = next[k];
      triangles[kept] = triangles[k];
      kept += near[kept] <= s_far ? 1 : 0;
    }
    top[i] = kept;
  }

 private:
  std::size_t room_ = 64;
  std::vector<float> nears_ = std::vector<float>(kMost * room_);  ///< where the ray enters the box
  std::vector<std::uint32_t> firsts_ = std::vector<std::uint32_t>(kMost * room_);
  std::vector<std::uint32_t> counts_ = std::vector<std::uint32_t>(kMost * room_);
};
