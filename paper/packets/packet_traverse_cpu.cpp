#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>

#include "base/bits.h"
#include "exec/radix_sort.h"
#include "exec/scan.h"
#include "exec/stopwatch.h"
#include "paper/packets/packet_leaves.h"

namespace raysheaf {
namespace {

constexpr std::size_t kPairGrain = 512;
constexpr std::size_t kPacketGrain = 4;

/// Two columns: packets, and nodes or leaves.
struct Pairs {
  std::vector<std::uint32_t> packets, places;

  [[nodiscard]] std::size_t size() const { return packets.size(); }
  void resize(std::size_t count) {
    packets.resize(count);
    places.resize(count);
  }
};

class Sweep {
 public:
  Sweep(const Executor& executor, const TriangleView& triangles, const Bvh& bvh,
        View<const Packet> packets, View<const Ray> rays, const PacketOptions& options,
        View<RayHit> best, View<float> ray_tests, ProgressMeter* meter)
      : executor_(executor),
        triangles_(triangles),
        bvh_(bvh),
        packets_(packets),
        rays_(rays),
        options_(options),
        best_(best),
        ray_tests_(ray_tests),
        meter_(*meter),
        capacity_(std::max(
            {std::size_t{options.pair_capacity}, bvh.nodes.size(), std::size_t{bvh.leaf_count}})),
        packet_tests_(ray_tests.empty() ? 0 : packets.size) {
    counts_.tests.resize(bvh.depth + 1);
    counts_.hits.resize(bvh.depth + 1);
  }

  PacketCounts run() {
    Stopwatch watch;
    bound_packets();
    counts_.packet_seconds = watch.lap_ms() / 1000;
    std::size_t size = std::max<std::size_t>(1, capacity_ / 256);
    for (std::size_t first = 0; first < packets_.size;) {
      const std::size_t count = std::min(size, packets_.size - first);
      const bool fits = descend(first, count);
      counts_.traverse_seconds += watch.lap_ms() / 1000;
      if (!fits) {
        size = std::max<std::size_t>(1, count / 2);
        continue;
      }
      meet_leaves(first, count);
      counts_.final_seconds += watch.lap_ms() / 1000;
      first += count;
    }
    share_packet_tests();
    for (const PacketLeaves& part : threads_) add(part.counts);
    return std::move(counts_);
  }

 private:
  void bound_packets() {
    frusta_.resize(packets_.size);
    executor_.for_each_block(packets_.size, kPacketGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<RayEnd> ends;
      for (std::size_t p = begin; p < end; ++p) {
        const View<const Ray> rays = rays_.slice(packets_[p].first, packets_[p].count);
        const auto axis = static_cast<int>(dominant_sense(rays[0].direction) / 2);
        ends.resize(2 * rays.size);
        frusta_[p] = bound_packet(rays, axis, triangles_.bounds, ends);
      }
    });
  }

  /// Fills `leaves_` with those that the packets intersect; returns false and counts nothing if
  /// they exceed the capacity.
  bool descend(std::size_t first, std::size_t count) {
    std::vector<std::uint64_t> tests(bvh_.depth), hits(bvh_.depth);
    leaves_.resize(0);
    queue_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      queue_.packets[i] = static_cast<std::uint32_t>(first + i);
      queue_.places[i] = 0;
    }
    for (std::uint32_t depth = 0; queue_.size() != 0; ++depth) {
      const std::size_t leaves_before = leaves_.size();
      tests[depth] = meet_queue();
      if (!advance_queue()) {
        if (!packet_tests_.empty()) std::fill_n(packet_tests_.data() + first, count, 0u);
        return false;
      }
      hits[depth] = queue_.size() + (leaves_.size() - leaves_before);
    }
    for (std::uint32_t depth = 0; depth < bvh_.depth; ++depth) {
      counts_.tests[bvh_.depth - depth] += tests[depth];
      counts_.hits[bvh_.depth - depth] += hits[depth];
    }
    return true;
  }

  /// Tests all pairs of the queue; returns the number of boxes tested.
  std::uint64_t meet_queue() {
    met_.resize(queue_.size());
    std::atomic<std::uint64_t> tests{0};
    executor_.for_each_block(queue_.size(), kPairGrain, [&](std::size_t begin, std::size_t end) {
      std::uint64_t boxes = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const BvhNode& node = bvh_.nodes[queue_.places[i]];
        met_[i] = meet_children(frusta_[queue_.packets[i]], node);
        boxes += node.children;
        if (packet_tests_.empty()) continue;
        std::atomic_ref(packet_tests_[queue_.packets[i]])
            .fetch_add(node.children, std::memory_order_relaxed);
      }
      tests += boxes;
    });
    return tests;
  }

  /// Moves the survivors to the next queue; leaves go to `leaves_`.
  bool advance_queue() {
    const std::size_t pairs = queue_.size();
    node_places_.resize(pairs);
    leaf_places_.resize(pairs);
    executor_.for_each(pairs, kPairGrain, [&](std::size_t i) {
      node_places_[i] = ones(met_[i].nodes);
      leaf_places_[i] = ones(met_[i].leaves);
    });
    const std::size_t nodes = exclusive_scan(executor_, node_places_, node_places_);
    const std::size_t leaves = exclusive_scan(executor_, leaf_places_, leaf_places_);
    const std::size_t leaves_before = leaves_.size();
    if (nodes > capacity_ || leaves_before + leaves > capacity_) return false;
    next_.resize(nodes);
    leaves_.resize(leaves_before + leaves);
    executor_.for_each(pairs, kPairGrain, [&](std::size_t i) {
      const std::uint32_t packet = queue_.packets[i], place = queue_.places[i];
      std::size_t to = node_places_[i];
      for (std::uint32_t bits = met_[i].nodes; bits != 0; bits &= bits - 1, ++to) {
        next_.packets[to] = packet;
        next_.places[to] = bvh_.nodes[place].first[__builtin_ctz(bits)];
      }
      to = leaves_before + leaf_places_[i];
      for (std::uint32_t bits = met_[i].leaves; bits != 0; bits &= bits - 1, ++to) {
        leaves_.packets[to] = packet;
        leaves_.places[to] = leaf_ref(place, static_cast<std::uint32_t>(__builtin_ctz(bits)));
      }
    });
    std::swap(queue_, next_);
    return true;
  }

  /// A stable sort makes each packet's leaves of all depths contiguous.
  void meet_leaves(std::size_t first, std::size_t count) {
    radix_sort_pairs(executor_, leaves_.packets, leaves_.places);
    executor_.for_each_block(count, kPacketGrain, [&](std::size_t begin, std::size_t end) {
      PacketLeaves& own = threads_.local();
      for (std::size_t p = first + begin; p < first + end; ++p) {
        meet_packet(p, &own);
        meter_.advance(1);
      }
    });
  }

  void meet_packet(std::size_t p, PacketLeaves* own) {
    const auto range = std::equal_range(leaves_.packets.begin(), leaves_.packets.end(), p);
    const auto at = static_cast<std::size_t>(range.first - leaves_.packets.begin());
    const auto leaf_count = static_cast<std::size_t>(range.second - range.first);
    if (leaf_count == 0) return;
    const Packet packet = packets_[p];
    const View<float> ray_tests =
        ray_tests_.empty() ? ray_tests_ : ray_tests_.slice(packet.first, packet.count);
    const std::uint64_t before = own->counts.triangle_tests;
    own->meet({frusta_[p], rays_.slice(packet.first, packet.count),
               View<const std::uint32_t>(leaves_.places).slice(at, leaf_count),
               best_.slice(packet.first, packet.count), ray_tests});
    if (!packet_tests_.empty())
      packet_tests_[p] += static_cast<std::uint32_t>(own->counts.triangle_tests - before);
  }

  void share_packet_tests() {
    executor_.for_each(packet_tests_.size(), kPairGrain, [&](std::size_t p) {
      const Packet packet = packets_[p];
      const float share = static_cast<float>(packet_tests_[p]) / static_cast<float>(packet.count);
      for (float& tests : ray_tests_.slice(packet.first, packet.count)) tests += share;
    });
  }

  void add(const LeafCounts& part) {
    counts_.tests[0] += part.triangle_tests;
    counts_.hits[0] += part.triangle_hits;
    counts_.final_tests += part.final_tests;
  }

  const Executor& executor_;
  const TriangleView triangles_;
  const Bvh& bvh_;
  const View<const Packet> packets_;
  const View<const Ray> rays_;
  const PacketOptions& options_;
  const View<RayHit> best_;
  const View<float> ray_tests_;
  ProgressMeter& meter_;
  const std::size_t capacity_;
  std::vector<std::uint32_t> packet_tests_;  ///< frustum tests of each packet; empty unless
                                             ///< requested
  std::vector<PacketFrustum> frusta_;
  Pairs queue_, next_, leaves_;
  std::vector<Met> met_;
  std::vector<std::uint32_t> node_places_, leaf_places_;
  oneapi::tbb::enumerable_thread_specific<PacketLeaves> threads_{
      [this] { return PacketLeaves(triangles_, bvh_, options_); }};
  PacketCounts counts_;
};

}  // namespace

PacketCounts traverse_packets(const Executor& executor, const TriangleView& triangles,
                              const Bvh& bvh, View<const Packet> packets, View<const Ray> rays,
                              const PacketOptions& options, View<RayHit> best,
                              View<float> ray_tests, ProgressMeter* meter) {
  if (bvh.nodes.empty() || packets.empty()) return {};
  return Sweep(executor, triangles, bvh, packets, rays, options, best, ray_tests, meter).run();
}

}  // namespace raysheaf
