// The hierarchy of object_tree/bvh.h, built on a device: the same tree. For sources that include a
// device.
//
// All nodes of a depth are built at once, in seven rounds:
//
//   choose, a thread a node ─► bin, a thread a triangle ─► cut, a thread a node
//        ▲                                                          ▼
//   divide, a thread a node ◄─ measure, a thread a triangle ◄─ move, a thread a triangle
//
// A round splits one child of each node; places within a run keep their order. O(triangles) work a
// round, and about 200 bytes of memory a triangle. The host waits once a depth, for the number of
// nodes.
#pragma once

#include <algorithm>
#include <utility>

#include "exec/atomic.h"
#include "exec/device.h"
#include "object_tree/bvh_build_body.h"
#include "object_tree/linear_tree_body.h"
#include "object_tree/triangle_list.h"

namespace raysheaf {

/// The split of one node's child in a round.
struct BvhCut {
  std::uint32_t child = kInvalidId;  ///< which is split; `kInvalidId`: none
  std::uint32_t first = 0, count = 0, left = 0;
  std::uint32_t bins = 0;  ///< on the left; 0: the run is halved as it is
  BvhBinning binning;

  [[nodiscard]] RAYSHEAF_HD bool has(std::uint32_t place) const {
    return child != kInvalidId && place - first < count;
  }
  [[nodiscard]] RAYSHEAF_HD bool goes_right(const BvhItem& item, std::uint32_t place) const {
    return bins != 0 ? binning.bin_of(item) >= bins : place - first >= left;
  }
};

/// Bins that threads fill together. Boxes begin with all bits set, counts with none.
struct SharedBins {
  SharedBox box[kBvhBins];
};
struct SharedBinCounts {
  std::uint64_t count[kBvhBins];
};
/// Boxes of the two halves of a run, and of their centres. All bits set before.
struct SharedHalves {
  SharedBox box[2], centers[2];
};

/// A build in a device's memory. Items lie in runs, one a node of the present depth.
struct BvhBuild {
  BvhItem* items = nullptr;
  std::uint32_t* owner = nullptr;  ///< of an item's place: its node, counted in this depth, or none
  BvhOpening* openings = nullptr;
  BvhCut* cuts = nullptr;
  SharedBins* bins = nullptr;
  SharedBinCounts* counts = nullptr;
  SharedHalves* halves = nullptr;
};

/// `whole`: the boxes of all, all bits set before, in its first half.
template <class Device>
void begin_bvh_on(Device& device, const TriangleList& list, const BvhBuild& build,
                  SharedHalves* whole) {
  const Vec3* const corners = list.corners.data;
  const std::uint32_t count = list.count();
  device.for_each("hierarchy: triangles", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const BvhItem item = bvh_item(static_cast<std::uint32_t>(i), corners[3 * i], corners[3 * i + 1],
                                  corners[3 * i + 2]);
    build.items[i] = item;
    build.owner[i] = 0;
    enlarge(&whole->box[0], {item.min, item.max});
    enlarge(&whole->centers[0], {item.center(), item.center()});
  });
  device.for_each("hierarchy: triangles", 1, [=] RAYSHEAF_DEVICE(std::size_t) {
    build.openings[0] = BvhOpening{};
    build.openings[0].child[0] = {0, count, box_of(whole->box[0]), box_of(whole->centers[0])};
  });
}

template <class Device>
void choose_cuts_on(Device& device, std::size_t nodes, const BvhBuild& build) {
  device.for_each("hierarchy: split", nodes, [=] RAYSHEAF_DEVICE(std::size_t n) {
    BvhCut cut;
    cut.child = build.openings[n].widest();
    if (cut.child != kInvalidId) {
      const BvhRun& run = build.openings[n].child[cut.child];
      cut.first = run.first;
      cut.count = run.count;
      cut.binning = BvhBinning(run.centers);
    }
    build.cuts[n] = cut;
  });
}

template <class Device>
void fill_bins_on(Device& device, std::uint32_t count, const BvhBuild& build) {
  device.for_each("hierarchy: split", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t n = build.owner[i];
    if (n == kInvalidId || !build.cuts[n].has(static_cast<std::uint32_t>(i))) return;
    const BvhItem item = build.items[i];
    const std::uint32_t b = build.cuts[n].binning.bin_of(item);
    enlarge(&build.bins[n].box[b], {item.min, item.max});
    add_to(&build.counts[n].count[b], 1);
  });
}

template <class Device>
void place_cuts_on(Device& device, std::size_t nodes, const BvhBuild& build) {
  device.for_each("hierarchy: split", nodes, [=] RAYSHEAF_DEVICE(std::size_t n) {
    BvhCut& cut = build.cuts[n];
    if (cut.child == kInvalidId) return;
    BvhBins bins;
    for (std::uint32_t b = 0; b < kBvhBins; ++b) {
      bins.count[b] = static_cast<std::uint32_t>(build.counts[n].count[b]);
      if (bins.count[b] != 0) bins.box[b] = box_of(build.bins[n].box[b]);
    }
    cut.bins = cheapest_cut(bins);
    cut.left = cut.bins == 0 ? cut.count / 2 : 0;
    for (std::uint32_t b = 0; b < cut.bins; ++b) cut.left += bins.count[b];
  });
}

/// Marks what moves to the right of its run.
template <class Device>
void mark_right_on(Device& device, std::uint32_t count, const BvhBuild& build,
                   std::uint32_t* right) {
  device.for_each("hierarchy: split", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t n = build.owner[i], place = static_cast<std::uint32_t>(i);
    const bool in_run = n != kInvalidId && build.cuts[n].has(place);
    right[i] = in_run && build.cuts[n].goes_right(build.items[i], place) ? 1 : 0;
  });
}

/// `rights`: the sums of `right` before each place.
template <class Device>
void move_items_on(Device& device, std::uint32_t count, const BvhBuild& build,
                   const std::uint32_t* right, const std::uint64_t* rights, BvhItem* moved) {
  device.for_each("hierarchy: split", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const BvhItem item = build.items[i];
    const std::uint32_t n = build.owner[i], place = static_cast<std::uint32_t>(i);
    if (n == kInvalidId || !build.cuts[n].has(place)) {
      moved[i] = item;
      return;
    }
    const BvhCut& cut = build.cuts[n];
    const auto before = static_cast<std::uint32_t>(rights[i] - rights[cut.first]);
    const std::uint32_t to = right[i] != 0 ? cut.first + cut.left + before : place - before;
    moved[to] = item;
    SharedHalves& halves = build.halves[n];
    enlarge(&halves.box[right[i]], {item.min, item.max});
    enlarge(&halves.centers[right[i]], {item.center(), item.center()});
  });
}

template <class Device>
void divide_runs_on(Device& device, std::size_t nodes, const BvhBuild& build) {
  device.for_each("hierarchy: split", nodes, [=] RAYSHEAF_DEVICE(std::size_t n) {
    const BvhCut& cut = build.cuts[n];
    if (cut.child == kInvalidId) return;
    BvhOpening& opening = build.openings[n];
    const SharedHalves& halves = build.halves[n];
    opening.child[opening.children++] = {cut.first + cut.left, cut.count - cut.left,
                                         box_of(halves.box[1]), box_of(halves.centers[1])};
    opening.child[cut.child] = {cut.first, cut.left, box_of(halves.box[0]),
                                box_of(halves.centers[0])};
  });
}

template <class Device>
void count_bvh_nodes_on(Device& device, std::size_t nodes, const BvhOpening* openings,
                        std::uint32_t* counts) {
  device.for_each("hierarchy: nodes", nodes,
                  [=] RAYSHEAF_DEVICE(std::size_t n) { counts[n] = openings[n].nodes(); });
}

/// Writes the nodes of a depth, of which `first` is the first; `places`: how many of the next
/// depth's belong to those before each.
template <class Device>
void write_bvh_nodes_on(Device& device, std::uint32_t first, std::size_t nodes,
                        const BvhOpening* openings, const std::uint64_t* places, BvhNode* out,
                        BvhOpening* next, std::uint64_t* leaves) {
  const std::uint32_t next_first = first + static_cast<std::uint32_t>(nodes);
  device.for_each("hierarchy: nodes", nodes, [=] RAYSHEAF_DEVICE(std::size_t n) {
    const BvhOpening& opening = openings[n];
    BvhNode& node = out[first + n];
    auto place = static_cast<std::uint32_t>(places[n]);
    node.children = opening.children;
    for (std::uint32_t c = 0; c < opening.children; ++c) {
      const BvhRun& run = opening.child[c];
      write_child(run, run.is_leaf() ? run.first : next_first + place, c, &node);
      if (run.is_leaf()) continue;
      next[place] = BvhOpening{};
      next[place++].child[0] = run;
    }
    add_to_common(leaves, opening.children - opening.nodes());
  });
}

/// Hands the items on to the nodes of the next depth.
template <class Device>
void hand_on_items_on(Device& device, std::uint32_t count, const BvhOpening* openings,
                      const std::uint64_t* places, std::uint32_t* owner) {
  device.for_each("hierarchy: nodes", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    if (owner[i] == kInvalidId) return;
    const BvhOpening& opening = openings[owner[i]];
    auto place = static_cast<std::uint32_t>(places[owner[i]]);
    for (std::uint32_t c = 0;; ++c) {
      const BvhRun& run = opening.child[c];
      if (static_cast<std::uint32_t>(i) - run.first < run.count) {
        owner[i] = run.is_leaf() ? kInvalidId : place;
        return;
      }
      place += run.is_leaf() ? 0 : 1;
    }
  });
}

template <class Device>
void take_bvh_triangles_on(Device& device, View<const BvhItem> items, std::uint32_t* triangles) {
  device.for_each("hierarchy: triangles", items.size,
                  [=] RAYSHEAF_DEVICE(std::size_t i) { triangles[i] = items.data[i].id; });
}

/// The tree and the memory to build it.
template <class Device>
class BvhOn {
 public:
  explicit BvhOn(Device& device) : device_(device) {}

  /// Replaces the tree. `list`: in the device's memory. If it throws, the tree is empty.
  void build(const TriangleList& list) {
    const std::uint32_t count = list.count();
    node_count_ = depth_ = 0;
    leaf_count_ = 0;
    if (count == 0) return;
    make_room(count);
    device_.fill("hierarchy: triangles", halves_.view(), 0xff);
    device_.fill("hierarchy: nodes", leaves_.view(), 0);
    begin_bvh_on(device_, list, there(), halves_.data());
    std::uint32_t first = 0, depth = 0;
    for (std::size_t nodes = 1; nodes != 0; ++depth) {
      for (std::uint32_t round = 1; round < kBvhWidth; ++round) split(count, nodes);
      const std::size_t next = write(count, first, nodes);
      first += static_cast<std::uint32_t>(nodes);
      nodes = next;
    }
    triangles_.resize_uninitialized("hierarchy: triangles", count);
    take_bvh_triangles_on(device_, items_.view_const(), triangles_.data());
    leaf_count_ = static_cast<std::uint32_t>(device_.read("hierarchy: nodes", leaves_.data()));
    node_count_ = first;
    depth_ = depth;
  }

  [[nodiscard]] View<const BvhNode> nodes() const { return {nodes_.data(), node_count_}; }
  [[nodiscard]] const std::uint32_t* triangles() const { return triangles_.data(); }
  [[nodiscard]] std::uint32_t depth() const { return depth_; }
  [[nodiscard]] std::uint32_t leaf_count() const { return leaf_count_; }

 private:
  [[nodiscard]] BvhBuild there() const {
    return {items_.data(), owner_.data(),  openings_.data(), cuts_.data(),
            bins_.data(),  counts_.data(), halves_.data()};
  }

  void make_room(std::uint32_t count) {
    constexpr const char* kStage = "hierarchy: triangles";
    items_.resize_uninitialized(kStage, count);
    moved_.resize_uninitialized(kStage, count);
    owner_.resize_uninitialized(kStage, count);
    right_.resize_uninitialized(kStage, count);
    rights_.resize_uninitialized(kStage, std::size_t{count} + 1);
    leaves_.resize_uninitialized(kStage, 1);
    openings_.resize_uninitialized(kStage, 1);
    make_room_for_nodes(1);
  }
  void make_room_for_nodes(std::size_t nodes) {
    constexpr const char* kStage = "hierarchy: split";
    cuts_.resize_uninitialized(kStage, nodes);
    bins_.resize_uninitialized(kStage, nodes);
    counts_.resize_uninitialized(kStage, nodes);
    halves_.resize_uninitialized(kStage, nodes);
    node_counts_.resize_uninitialized(kStage, nodes);
    places_.resize_uninitialized(kStage, nodes + 1);
  }

  /// Splits a child of each node that has one to split.
  void split(std::uint32_t count, std::size_t nodes) {
    device_.fill("hierarchy: split", bins_.view(), 0xff);
    device_.fill("hierarchy: split", counts_.view(), 0);
    device_.fill("hierarchy: split", halves_.view(), 0xff);
    const BvhBuild build = there();
    choose_cuts_on(device_, nodes, build);
    fill_bins_on(device_, count, build);
    place_cuts_on(device_, nodes, build);
    mark_right_on(device_, count, build, right_.data());
    device_.exclusive_scan("hierarchy: split", right_.view_const(), rights_.view());
    move_items_on(device_, count, build, right_.data(), rights_.data(), moved_.data());
    divide_runs_on(device_, nodes, build);
    items_.swap(moved_);
  }

  /// Writes the nodes of a depth; returns how many the next has.
  std::size_t write(std::uint32_t count, std::uint32_t first, std::size_t nodes) {
    grow_nodes(first, first + nodes);
    count_bvh_nodes_on(device_, nodes, openings_.data(), node_counts_.data());
    device_.exclusive_scan("hierarchy: nodes", node_counts_.view_const(), places_.view());
    const std::size_t next = device_.read("hierarchy: nodes", places_.data() + nodes);
    next_.resize_uninitialized("hierarchy: nodes", next);
    write_bvh_nodes_on(device_, first, nodes, openings_.data(), places_.data(), nodes_.data(),
                       next_.data(), leaves_.data());
    hand_on_items_on(device_, count, openings_.data(), places_.data(), owner_.data());
    openings_.swap(next_);
    if (next != 0) make_room_for_nodes(next);
    return next;
  }

  /// Room for `count` nodes, of which `written` are kept.
  void grow_nodes(std::size_t written, std::size_t count) {
    constexpr const char* kStage = "hierarchy: nodes";
    if (count <= nodes_.size()) return;
    DeviceBuffer<BvhNode> more(memory_);
    more.resize_uninitialized(kStage, std::max(count, 2 * nodes_.size()));
    if (written != 0) device_.copy(kStage, more.data(), nodes_.data(), written * sizeof(BvhNode));
    nodes_.swap(more);
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceBuffer<BvhNode> nodes_{memory_};
  DeviceBuffer<std::uint32_t> triangles_{memory_};
  std::size_t node_count_ = 0;
  std::uint32_t depth_ = 0, leaf_count_ = 0;
  // During a build, of triangles
  DeviceBuffer<BvhItem> items_{memory_}, moved_{memory_};
  DeviceBuffer<std::uint32_t> owner_{memory_}, right_{memory_};
  DeviceBuffer<std::uint64_t> rights_{memory_}, leaves_{memory_};
  // and of the nodes of a depth.
  DeviceBuffer<BvhOpening> openings_{memory_}, next_{memory_};
  DeviceBuffer<BvhCut> cuts_{memory_};
  DeviceBuffer<SharedBins> bins_{memory_};
  DeviceBuffer<SharedBinCounts> counts_{memory_};
  DeviceBuffer<SharedHalves> halves_{memory_};
  DeviceBuffer<std::uint32_t> node_counts_{memory_};
  DeviceBuffer<std::uint64_t> places_{memory_};
};

}  // namespace raysheaf
