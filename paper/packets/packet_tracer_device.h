// The method `gl10` on a device: rays are ordered by their keys and cut into packets. The packets
// traverse the hierarchy over the triangles, level by level, as lists of (packet, node) pairs, and
// then their leaves (paper/packets/packet_traverse.h). The hierarchy is the CPU's, which builds
// it (paper/packets/bvh.h). Hits and counts are those of the CPU, test for test.
//
// As on the CPU, packets are processed in batches, so that no list overflows.
//
// For sources that include a device.
#pragma once

#include <algorithm>

#include "device/report_times.h"
#include "device/triangles_device.h"
#include "exec/stopwatch.h"
#include "paper/order/key_order_device.h"
#include "paper/packets/packet_cuts_device.h"
#include "paper/packets/packet_loops_device.h"
#include "render/device/device_batch_tracer.h"

namespace raysheaf {

template <class Device>
class PacketTracerOn : public DeviceBatchTracer {
 public:
  /// `capacity`: of each list of pairs, if a packet does not need more; `most_rays`: of a packet;
  /// the other arguments construct the device.
  template <class... Args>
  explicit PacketTracerOn(std::uint32_t capacity, std::uint32_t most_rays, Args&&... args)
      : asked_capacity_(capacity), most_rays_(most_rays), device_(std::forward<Args>(args)...) {}

  /// Builds the hierarchy on the CPU and copies it to the device.
  void set_scene(const Executor& executor, const FlatScene& scene,
                 const TriangleList& triangles) override {
    depth_ = 0;
    scene_triangles_.set(triangles);
    const View<const Vec3> there = scene_triangles_.list().corners;
    std::vector<Vec3> corners(there.size);
    device_.copy("copy: triangles", corners.data(), there.data, there.size * sizeof(Vec3));
    device_.synchronize("copy: triangles");
    const Bvh bvh = build_bvh(executor, View<const Vec3>(corners));
    upload(device_, "copy: nodes", View<const BvhNode>(bvh.nodes), &nodes_);
    upload(device_, "copy: nodes", View<const std::uint32_t>(bvh.triangles), &leaf_triangles_);
    device_.synchronize("copy: nodes");
    bounds_ = scene.bounds;
    capacity_ =
        std::max({std::size_t{asked_capacity_}, bvh.nodes.size(), std::size_t{bvh.leaf_count}});
    depth_ = bvh.depth;
  }

  void trace(View<const Ray> rays, View<const std::uint32_t> keys, std::uint32_t key_bits,
             const BatchOptions& options, View<IndexedHit> hits, BatchStatistics* statistics,
             QueryReport* report) override {
    if (rays.empty()) return;
    Stopwatch watch;
    check_item_count("rays", std::size_t{2} * rays.size);
    device_.keep_times(report != nullptr);
    upload(device_, "copy: rays", rays, &given_);
    statistics->chunks += order_.sort(keys, rays.size, key_bits);
    view_ = {};
    view_.rays = given_.view_const();
    view_.list = scene_triangles_.list();
    best_.resize_uninitialized("trace: final tests", rays.size);
    begin_hits_on(device_, best_.view());
    View<const std::uint32_t> order = order_.order();
    if (depth_ != 0) {
      make_packets(options, key_bits);
      order = cuts_.order();
      LevelCounts counts;
      trace_packets(&counts);
      counts.add_to(statistics);
    }
    hits_.resize_uninitialized("trace: hits", rays.size);
    scatter_best_on(device_, view_, best_.view_const(), order.data, hits_.data());
    device_.copy("copy: hits", hits.data, hits_.data(), hits.size * sizeof(IndexedHit));
    device_.synchronize("hits");
    if (report != nullptr) {
      add_times(device_.times(), report);
      report->total_ms += watch.lap_ms();
    }
    device_.keep_times(false);
  }

 private:
  /// Makes packets of the ordered rays, their bounds, and room for pairs.
  void make_packets(const BatchOptions& options, std::uint32_t key_bits) {
    const std::size_t rays = given_.size();
    sorted_keys_.resize_uninitialized("hierarchy: packets", order_.keys().size);
    if (!order_.keys().empty())
      gather(device_, "hierarchy: packets", order_.keys(), order_.order(), sorted_keys_.view());
    cuts_.cut({given_.view_const(), order_.order(), sorted_keys_.view_const(), key_bits},
              most_rays_);
    rays_.resize_uninitialized("order: rays", rays);
    gather(device_, "order: rays", given_.view_const(), cuts_.order(), rays_.view());
    ends_.resize_uninitialized("hierarchy: packets", std::size_t{2} * rays);
    frusta_.resize_uninitialized("hierarchy: packets", cuts_.packets().size);
    bound_packets_on(device_, rays_.view_const(), cuts_.packets(), bounds_, ends_.data(),
                     frusta_.data());
    for (List* list : {&queue_, &next_, &leaves_}) {
      list->packets.resize_uninitialized("trace: queue", capacity_);
      list->places.resize_uninitialized("trace: queue", capacity_);
    }
    met_.resize_uninitialized("trace: queue", capacity_);
    for (DeviceBuffer<std::uint32_t>* column : {&boxes_, &node_counts_, &leaf_counts_})
      column->resize_uninitialized("trace: queue", capacity_);
    for (DeviceBuffer<std::uint64_t>* places : {&box_sums_, &node_places_, &leaf_places_})
      places->resize_uninitialized("trace: queue", capacity_ + 1);
    view_ = {rays_.view_const(), cuts_.packets(),        frusta_.data(), view_.list,
             nodes_.data(),      leaf_triangles_.data(), options.facing, options.early_out};
  }

  void trace_packets(LevelCounts* counts) {
    counts->tests.resize(depth_ + 1);
    counts->hits.resize(depth_ + 1);
    counts_ = counts;
    final_tests_.resize_uninitialized("trace: final tests", 1);
    device_.fill("trace: final tests", final_tests_.view(), 0);
    const std::size_t packets = view_.packets.size;
    std::size_t size = std::max<std::size_t>(1, capacity_ / 256);
    for (std::size_t first = 0; first < packets;) {
      const std::size_t count = std::min(size, packets - first);
      if (!descend(static_cast<std::uint32_t>(first), count)) {
        size = std::max<std::size_t>(1, count / 2);
        continue;
      }
      const Packet begin = device_.read("trace: queue", view_.packets.data + first);
      const Packet last = device_.read("trace: queue", view_.packets.data + first + count - 1);
      meet_leaves({begin.first, last.first + last.count - begin.first});
      first += count;
    }
    counts->final_tests = device_.read("trace: final tests", final_tests_.data());
  }

  /// The sum of `count` numbers; `places` receives the sums before each.
  std::uint64_t sum(const DeviceBuffer<std::uint32_t>& numbers, std::size_t count,
                    const DeviceBuffer<std::uint64_t>& places) {
    device_.exclusive_scan("trace: queue", numbers.view_const().slice(0, count),
                           places.view().slice(0, count + 1));
    return device_.read("trace: queue", places.data() + count);
  }

  /// Fills `leaves_` with those that the packets intersect; returns false and counts nothing if
  /// they exceed the capacity.
  bool descend(std::uint32_t first, std::size_t count) {
    const std::uint32_t levels = depth_;
    std::vector<std::uint64_t> tests(levels), hits(levels);
    leaf_pairs_ = 0;
    begin_queue_on(device_, first, count, queue_.pairs());
    for (std::uint32_t depth = 0; count != 0; ++depth) {
      meet_nodes_on(device_, view_, queue_.pairs(), count, met_.data(),
                    {boxes_.data(), node_counts_.data(), leaf_counts_.data()});
      tests[depth] = sum(boxes_, count, box_sums_);
      const std::uint64_t nodes = sum(node_counts_, count, node_places_);
      const std::uint64_t leaves = sum(leaf_counts_, count, leaf_places_);
      hits[depth] = nodes + leaves;
      if (nodes > capacity_ || leaf_pairs_ + leaves > capacity_) return false;
      advance_on(device_, view_, queue_.pairs(), count, met_.data(), node_places_.data(),
                 next_.pairs(), leaf_places_.data(), leaves_.pairs_from(leaf_pairs_));
      leaf_pairs_ += leaves;
      std::swap(queue_, next_);
      count = nodes;
    }
    for (std::uint32_t depth = 0; depth < levels; ++depth) {
      counts_->tests[levels - depth] += tests[depth];
      counts_->hits[levels - depth] += hits[depth];
    }
    return true;
  }

  /// Tests the triangles of the leaves, near ones first, with the rays of the range.
  void meet_leaves(Packet range) {
    const std::size_t pairs = leaf_pairs_;
    if (pairs == 0) return;
    count_candidates_on(device_, view_, leaves_.pairs(), pairs, boxes_.data(), node_counts_.data());
    counts_->tests[0] += sum(boxes_, pairs, box_sums_);
    const std::uint64_t count = sum(node_counts_, pairs, node_places_);
    counts_->hits[0] += count;
    if (count == 0) return;
    check_item_count("trace: leaves", count);
    by_triangle_.resize_uninitialized("trace: leaves", count, true);
    by_begin_.resize_uninitialized("trace: leaves", count, true);
    keys_.resize_uninitialized("trace: leaves", count);
    triangles_.resize_uninitialized("trace: leaves", count);
    list_candidates_on(device_, view_, leaves_.pairs(), pairs, node_places_.data(),
                       {triangles_.data(), keys_.data()});
    // Sorts by triangle and then, stably, by packet and begin.
    device_.copy("trace: leaves", by_triangle_.keys.data(), triangles_.data(),
                 count * sizeof(std::uint32_t));
    number(device_, "trace: leaves", by_triangle_.values.view());
    device_.sort_pairs("trace: leaves", &by_triangle_, {0, 32});
    gather(device_, "trace: leaves", keys_.view_const(), by_triangle_.values.view_const(),
           by_begin_.keys.view());
    device_.copy("trace: leaves", by_begin_.values.data(), by_triangle_.keys.data(),
                 count * sizeof(std::uint32_t));
    device_.sort_pairs("trace: leaves", &by_begin_, {0, 64});
    meet_candidates_on(device_, view_, {by_begin_.keys.view_const(), by_begin_.values.data()},
                       range, best_.data(), final_tests_.data());
  }

  struct List {
    explicit List(DeviceAllocator& allocator) : packets(allocator), places(allocator) {}
    [[nodiscard]] PacketPairs pairs() const { return pairs_from(0); }
    [[nodiscard]] PacketPairs pairs_from(std::size_t first) const {
      return {packets.data() + first, places.data() + first};
    }
    DeviceBuffer<std::uint32_t> packets, places;
  };

  const std::uint32_t asked_capacity_, most_rays_;
  Device device_;
  DeviceAllocator& memory_ = device_.allocator();
  GivenTriangles<Device> scene_triangles_{device_};
  DeviceBuffer<BvhNode> nodes_{memory_};
  DeviceBuffer<std::uint32_t> leaf_triangles_{memory_};
  std::uint32_t depth_ = 0;  ///< of the hierarchy; 0: there are no triangles
  DeviceBuffer<Ray> given_{memory_}, rays_{memory_};
  KeyOrderOn<Device> order_{device_};
  DeviceBuffer<std::uint32_t> sorted_keys_{memory_};
  PacketCutsOn<Device> cuts_{device_};
  DeviceBuffer<RayEnd> ends_{memory_};
  DeviceBuffer<PacketFrustum> frusta_{memory_};
  DeviceBuffer<RayHit> best_{memory_};
  DeviceBuffer<IndexedHit> hits_{memory_};
  DeviceBuffer<std::uint64_t> final_tests_{memory_};
  List queue_{memory_}, next_{memory_}, leaves_{memory_};
  DeviceBuffer<Met> met_{memory_};
  DeviceBuffer<std::uint32_t> boxes_{memory_}, node_counts_{memory_}, leaf_counts_{memory_};
  DeviceBuffer<std::uint64_t> box_sums_{memory_}, node_places_{memory_}, leaf_places_{memory_};
  DeviceBuffer<std::uint32_t> triangles_{memory_};
  DeviceBuffer<std::uint64_t> keys_{memory_};
  SortColumns<std::uint32_t> by_triangle_{memory_};
  SortColumns<std::uint64_t> by_begin_{memory_};
  Box bounds_;
  std::size_t capacity_ = 0, leaf_pairs_ = 0;
  PacketView view_;
  LevelCounts* counts_ = nullptr;
};

}  // namespace raysheaf
