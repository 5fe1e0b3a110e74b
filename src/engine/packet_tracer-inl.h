// A tracer of packets on a device of a known kind; for the sources that make one.
#pragma once

#include <algorithm>

#include "engine/packet_loops-inl.h"
#include "exec/stopwatch.h"

namespace raysheaf {

template <class Device>
class PacketTracerOn : public PacketTracer {
 public:
  /// `capacity`: of each list of pairs, but for the least that a packet may need; the rest is what
  /// the device is made from.
  template <class... Args>
  explicit PacketTracerOn(std::uint32_t capacity, Args&&... args)
      : asked_capacity_(capacity), device_(std::forward<Args>(args)...) {}

  void set_scene(const PacketScene& scene) override {
    upload("copy: triangles", scene.corners, &corners_);
    upload("copy: triangles", scene.flags, &flags_);
    upload("copy: hierarchy", View<const BvhNode>(scene.bvh.nodes.data(), scene.bvh.nodes.size()),
           &nodes_);
    upload("copy: hierarchy", View<const std::uint32_t>(scene.bvh.triangles), &leaf_triangles_);
    device_.synchronize("copy: triangles");
    bounds_ = scene.bounds;
    depth_ = scene.bvh.depth();
    capacity_ = std::max(
        {std::size_t{asked_capacity_}, scene.bvh.nodes.size(), std::size_t{scene.bvh.leaf_count}});
  }

  PacketCounts trace(const PacketBatch& batch, View<RayHit> best) override {
    PacketCounts counts;
    std::fill(best.begin(), best.end(), RayHit{});
    if (nodes_.size() == 0 || batch.packets.empty()) return counts;
    check_item_count("rays", std::size_t{2} * batch.rays.size);
    counts.tests.resize(depth_ + 1);
    counts.hits.resize(depth_ + 1);
    counts_ = &counts;
    Stopwatch watch;
    begin(batch, best.size);
    counts.packet_seconds = lap(&watch);
    std::size_t size = std::max<std::size_t>(1, capacity_ / 256);
    for (std::size_t first = 0; first < batch.packets.size;) {
      const std::size_t count = std::min(size, batch.packets.size - first);
      const bool fits = descend(static_cast<std::uint32_t>(first), count);
      counts.traverse_seconds += lap(&watch);
      if (!fits) {
        size = std::max<std::size_t>(1, count / 2);
        continue;
      }
      const Packet& last = batch.packets[first + count - 1];
      const std::uint32_t first_ray = batch.packets[first].first;
      meet_leaves({first_ray, last.first + last.count - first_ray});
      counts.final_seconds += lap(&watch);
      first += count;
    }
    device_.copy("copy: hits", best.data, best_.data(), best.size * sizeof(RayHit));
    counts.final_tests = device_.read("trace: final tests", final_tests_.data());
    return counts;
  }

 private:
  template <class T>
  void upload(const char* stage, View<const T> from, DeviceBuffer<T>* to) {
    to->resize_uninitialized(stage, from.size);
    if (!from.empty()) device_.copy(stage, to->data(), from.data, from.size * sizeof(T));
  }
  double lap(Stopwatch* watch) {
    device_.synchronize("packets");
    return watch->lap_ms() / 1000;
  }

  /// Rays and packets to the device, and the packets' bounds.
  void begin(const PacketBatch& batch, std::size_t rays) {
    upload("copy: rays", batch.rays, &rays_);
    upload("copy: rays", batch.packets, &packets_);
    ends_.resize_uninitialized("hierarchy: packets", std::size_t{2} * rays);
    frusta_.resize_uninitialized("hierarchy: packets", batch.packets.size);
    bound_packets_on(device_, rays_.view_const(), packets_.view_const(), bounds_, ends_.data(),
                     frusta_.data());
    best_.resize_uninitialized("trace: final tests", rays);
    // Of rays whose packets have no leaves: no hit.
    const std::vector<RayHit> none(rays);
    device_.copy("trace: final tests", best_.data(), none.data(), rays * sizeof(RayHit));
    final_tests_.resize_uninitialized("trace: final tests", 1);
    device_.fill("trace: final tests", final_tests_.view(), 0);
    for (List* list : {&queue_, &next_, &leaves_}) {
      list->packets.resize_uninitialized("trace: queue", capacity_);
      list->places.resize_uninitialized("trace: queue", capacity_);
    }
    met_.resize_uninitialized("trace: queue", capacity_);
    for (DeviceBuffer<std::uint32_t>* column : {&boxes_, &node_counts_, &leaf_counts_})
      column->resize_uninitialized("trace: queue", capacity_);
    for (DeviceBuffer<std::uint64_t>* places : {&box_sums_, &node_places_, &leaf_places_})
      places->resize_uninitialized("trace: queue", capacity_ + 1);
    view_ = {rays_.view_const(),   packets_.view_const(),
             frusta_.data(),       {corners_.view_const(), flags_.view_const()},
             nodes_.data(),        leaf_triangles_.data(),
             batch.options.facing, batch.options.early_out};
  }

  /// The sum of `count` numbers; `places` takes the sums before each.
  std::uint64_t sum(const DeviceBuffer<std::uint32_t>& numbers, std::size_t count,
                    const DeviceBuffer<std::uint64_t>& places) {
    device_.exclusive_scan("trace: queue", numbers.view_const().slice(0, count),
                           places.view().slice(0, count + 1));
    return device_.read("trace: queue", places.data() + count);
  }

  /// Fills `leaves_` with those that the packets met; false, and nothing counted, where that takes
  /// more than the capacity.
  bool descend(std::uint32_t first, std::size_t count) {
    std::vector<std::uint64_t> tests(depth_), hits(depth_);
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
    for (std::uint32_t depth = 0; depth < depth_; ++depth) {
      counts_->tests[depth_ - depth] += tests[depth];
      counts_->hits[depth_ - depth] += hits[depth];
    }
    return true;
  }

  /// What is in the leaves, near ones first, with the rays of the range.
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
    // By triangle, then, stable, by packet and begin.
    device_.copy("trace: leaves", by_triangle_.keys.data(), triangles_.data(),
                 count * sizeof(std::uint32_t));
    number_candidates_on(device_, by_triangle_.values.view());
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

  const std::uint32_t asked_capacity_;
  Device device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceBuffer<Vec3> corners_{memory_};
  DeviceBuffer<std::uint8_t> flags_{memory_};
  DeviceBuffer<BvhNode> nodes_{memory_};
  DeviceBuffer<std::uint32_t> leaf_triangles_{memory_};
  DeviceBuffer<Ray> rays_{memory_};
  DeviceBuffer<Packet> packets_{memory_};
  DeviceBuffer<RayEnd> ends_{memory_};
  DeviceBuffer<PacketFrustum> frusta_{memory_};
  DeviceBuffer<RayHit> best_{memory_};
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
  std::uint32_t depth_ = 0;
  std::size_t capacity_ = 0, leaf_pairs_ = 0;
  PacketView view_;
  PacketCounts* counts_ = nullptr;
};

}  // namespace raysheaf
