// Blocks of a stream's rays, from node to node, while most rays of a block stay together. Included
// once a SIMD target by methods/dual/trace_simd.cpp, inside its namespace.
//
//   list    5: 1111111111111111   6: 1111111111110000   7: ...     blocks and their rays in the
//   list
//             | |                     a block's beam is tested with a node's eight boxes at once,
//             v v                     and its rays with those boxes only that the beam meets
//   child   5: 0000001111111111   6: 1111000000000000
//
// Rays are read where they stand, neither gathered nor moved. Where blocks have lost too many, what
// is left goes on as a list of rays.

/// Blocks that keep fewer rays each, on average, go on as rays.
inline constexpr std::uint32_t kRaysOfBlock = 6;
/// The same of blocks at a leaf.
inline constexpr std::uint32_t kRaysOfBlockAtLeaf = 4;

/// So many rays of a block get records one by one, more of them all at once.
inline constexpr int kFewRecords = 3;

/// Fewer beams than these are tested with all children at a time, instead of with each other.
inline constexpr std::uint32_t kFewBlocks = 4;

/// The beams of as many blocks as a vector has lanes.
struct BeamLanes {
  RV z_low, z_high, start, end;
  struct Planes {
    RV at, inverse;
    RM opens;  ///< the plane recedes from its axis's lower end
  };
  Planes x_low, x_high, y_low, y_high;

  /// `words`: BlockRays.
  HWY_INLINE BeamLanes(const Beam* beams, const std::uint32_t* words) {
    static_assert(sizeof(BlockRays) == 4);
    const RayInts d;
    alignas(64) std::uint32_t blocks[kBundleWidth];
    hn::Store(hn::And(hn::Load(d, words), hn::Set(d, 0xffff)), d, blocks);
    gather4(beams, 0, blocks, z_low, z_high, start, end);
    gather4(beams, 1, blocks, x_low.at, x_low.inverse, x_high.at, x_high.inverse);
    gather4(beams, 2, blocks, y_low.at, y_low.inverse, y_high.at, y_high.inverse);
    for (Planes* planes : {&x_low, &x_high, &y_low, &y_high})
      planes->opens = hn::Gt(planes->inverse, hn::Zero(Rays()));
  }

  /// Those that meet a child: `children_in_beam`, operation by operation.
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

template <class Mode>
class StreamBlocks : protected StreamLists<Mode> {
 protected:
  using StreamHits<Mode>::tree_, StreamHits<Mode>::stream_, StreamHits<Mode>::counts_;
  using StreamHits<Mode>::take_in_block;
  using StreamLists<Mode>::meet_triangles, StreamLists<Mode>::pad_list;
  using StreamSingles<Mode>::walk_singles_of_stream;

  explicit StreamBlocks(const TraceJob& job) : StreamLists<Mode>(job) {}

  /// What stands from `offset` on in the lists, `size` rays or blocks, the least first, through the
  /// tree; what stands there is lost.
  void walk(std::uint32_t offset, std::uint32_t size, bool in_blocks) {
    if (size == 0) return;
    stream_.waiting.clear();
    stream_.waiting.push_back({0, 0, offset, size, in_blocks});
    while (!stream_.waiting.empty()) {
      this->job_.executor->check();
      const WaitingList next = stream_.waiting.back();
      stream_.waiting.pop_back();
      meet_list(next);
    }
    walk_singles_of_stream();
  }

  /// What comes next for the rays of a list.
  HWY_INLINE void meet_list(const WaitingList& list) {
    if (!list.in_blocks) {
      meet(list);
    } else if (list.count != 0) {
      meet_leaf_in_blocks(list);
    } else {
      open_blocks(list);
    }
  }

  /// Those of a block's rays that are `some` have records of their own from now on.
  HWY_INLINE void leave_block(std::uint32_t block, std::uint32_t some) {
    const std::uint32_t leave = some & ~stream_.recorded[block];
    if (leave != 0) make_records(block, leave);
  }

  /// Triangles from a place on with rays of a block.
  HWY_INLINE void meet_block(std::uint32_t first, std::uint32_t count, BlockRays rays) {
    const StreamBlock& b = stream_.blocks[rays.block];
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
      const LeafRays r{load(b.ox + g),      load(b.oy + g),      load(b.oz + g),
                       load(b.t_limit + g), load(b.shear_x + g), load(b.shear_y + g),
                       load(b.shear_z + g), load(b.t_min + g)};
      meet_triangles(first, count, r,
                     [&](std::uint32_t place, const Tested<Rays>& tested)
                         HWY_ATTR { take_in_block(place, rays, g, tested); });
    }
  }

  void meet_leaf_in_blocks(const WaitingList& list) {
    const auto* from = reinterpret_cast<const BlockRays*>(stream_.lists.data() + list.offset);
    std::uint32_t rays = 0;
    for (std::uint32_t i = 0; i < list.size; ++i) {
      rays += static_cast<std::uint32_t>(__builtin_popcount(from[i].rays));
      meet_block(4 * list.first, list.count, from[i]);
    }
    counts_.triangle_tests += std::uint64_t{rays} * list.count;
  }

 private:
  using StreamLists<Mode>::box_of, StreamLists<Mode>::meet;
  using StreamLists<Mode>::sorted_children, StreamLists<Mode>::subtrees_;

  static constexpr std::uint32_t kMostBlocks = kStreamRays / kBundleWidth;

  HWY_NOINLINE void make_records(std::uint32_t block, std::uint32_t leave) {
    const StreamBlock& b = stream_.blocks[block];
    StreamRay* const rays = stream_.rays.data() + std::size_t{block} * kBundleWidth;
    if (__builtin_popcount(leave) <= kFewRecords) {
      stream_.recorded[block] |= leave;
      for (; leave != 0; leave &= leave - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(leave));
        rays[lane] = b.ray(lane);
      }
      return;
    }
    stream_.recorded[block] = 0xffff;
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

  /// Room for kBundleWidth more is needed.
  void keep_blocks(std::uint32_t c, std::uint32_t blocks, std::uint32_t offset) {
    std::memcpy(stream_.lists.data() + offset, found_[c], blocks * sizeof(BlockRays));
    pad_list(offset, blocks);
  }

  /// The same as a list of rays; room for kBundleWidth more is needed.
  void keep_rays(std::uint32_t c, std::uint32_t blocks, std::uint32_t offset) {
    std::uint32_t* out = stream_.lists.data() + offset;
    for (std::uint32_t i = 0; i < blocks; ++i) {
      const BlockRays from = found_[c][i];
      leave_block(from.block, from.rays);
      out = append_lanes(from.block * kBundleWidth, from.rays, out);
    }
  }

  /// What of a block's rays meets a box.
  HWY_INLINE std::uint32_t rays_in_box(const StreamBlock& b, const SeenBox& box) const {
    std::uint32_t met = 0;
    for (std::size_t g = 0; g < kBundleWidth; g += ray_lanes()) {
      const RV oz = load(b.oz + g);
      const SlabRays rays{load(b.ox + g),    load(b.oy + g),    stream_.mirrored ? hn::Neg(oz) : oz,
                          load(b.per_x + g), load(b.per_y + g), load(b.s_near + g),
                          load(b.s_far + g)};
      met |= bits_of(Rays(), meeting(rays, box)) << g;
    }
    return met;
  }

  /// Blocks whose beams meet a child, for each child: how many there are.
  void meet_beams(const BvhNode& node, const WaitingList& list, std::uint32_t* found) {
    if (list.size <= kFewBlocks) {
      meet_beams_one_by_one(node, list, found);
    } else {
      meet_beams_together(node, list, found);
    }
  }

  HWY_INLINE void meet_beams_one_by_one(const BvhNode& node, const WaitingList& list,
                                        std::uint32_t* found) {
    const auto* from = reinterpret_cast<const BlockRays*>(stream_.lists.data() + list.offset);
    alignas(64) float near[kBvhWidth];
    std::uint32_t ends[kBvhWidth] = {};
    for (std::uint32_t i = 0; i < list.size; ++i) {
      const BlockRays rays = from[i];
      const std::uint32_t met = children_in_beam(stream_, stream_.beams[rays.block], node, near);
      for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
        found_[c][ends[c]] = rays;
        ends[c] += met >> c & 1;
      }
    }
    std::copy_n(ends, kBvhWidth, found);
  }

  /// As many beams as there are lanes with a child at a time.
  HWY_NOINLINE void meet_beams_together(const BvhNode& node, const WaitingList& list,
                                        std::uint32_t* found) {
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

  void open_blocks(const WaitingList& list) {
    RayStream& s = stream_;
    const BvhNode& node = tree_.nodes[list.first];
    std::uint32_t children[kBvhWidth], found[kBvhWidth];
    const std::uint32_t child_count = sorted_children(node, children);
    counts_.beam_box_tests += std::uint64_t{list.size} * child_count;
    meet_beams(node, list, found);
    std::uint32_t end = list.offset;
    for (std::uint32_t k = 0; k < child_count; ++k) {
      const std::uint32_t c = children[k];
      const auto box = box_of(node, c);
      BlockRays* const rows = found_[c];
      std::uint32_t blocks = 0, tests = 0, rays = 0;
      for (std::uint32_t i = 0; i < found[c]; ++i) {
        const BlockRays before = rows[i];
        const std::uint32_t met = rays_in_box(s.blocks[before.block], box) & before.rays;
        tests += static_cast<std::uint32_t>(__builtin_popcount(before.rays));
        rays += static_cast<std::uint32_t>(__builtin_popcount(met));
        rows[blocks] = {before.block, static_cast<std::uint16_t>(met)};
        blocks += met != 0 ? 1 : 0;
      }
      counts_.ray_box_tests += tests;
      if (blocks == 0) continue;
      const bool together = rays >= (node.is_leaf(c) ? kRaysOfBlockAtLeaf : kRaysOfBlock) * blocks;
      const std::uint32_t size = together ? blocks : rays;
      s.grow_lists(std::size_t{end} + size + 2 * kBundleWidth);
      if (together) {
        keep_blocks(c, blocks, end);
      } else {
        keep_rays(c, blocks, end);
        pad_list(end, size);
      }
      s.waiting.push_back({node.first[c], node.count[c], end, size, together});
      subtrees_.prefetch(node.first[c], node.count[c]);
      end += (size + kBundleWidth + 15) / 16 * 16;
    }
  }

  alignas(64) BlockRays found_[kBvhWidth][kMostBlocks + kBundleWidth];  ///< by child
};
