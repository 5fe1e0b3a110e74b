// Packets against a hierarchy over the triangles, level by level, and the final tests (Garanzha &
// Loop 2010, "Fast Ray Sorting and Breadth-First Packet Traversal for GPU Ray Tracing").
//
//   queue of depth d      (packet, node) ...          sorted by packet
//      | the packet's frustum with the boxes of the node's children, all pairs in parallel
//      | survivors side by side, by scans
//      v
//   queue of depth d + 1  (packet, node) ...    and   leaves  (packet, leaf) ...
//
// When the queue is empty, each packet takes its leaves: the frustum with their triangles one by
// one, then its rays with the triangles that are left, near ones first. A ray passes over triangles
// that begin behind the hit it has.
//
// Packets go in batches. A batch whose queue or leaves would be more than the capacity is done
// again with half the packets, so nothing is dropped; one packet always fits, because the capacity
// is at least the number of nodes and of leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "intersect/triangle_view.h"
#include "methods/packets/packets.h"
#include "object_tree/bvh.h"

namespace raysheaf {

inline constexpr std::uint32_t kPairCapacity = 1u << 18;

struct PacketOptions {
  bool early_out = false;  ///< rays that met something are tested no more
  Facing facing = Facing::kBoth;
  std::uint32_t pair_capacity = kPairCapacity;
};

/// Frustum tests by level: 1 is triangles of leaves, 2 the boxes in the deepest nodes, and so on to
/// the boxes in the root.
struct PacketCounts {
  std::vector<std::uint64_t> tests, hits;  ///< [0] is level 1
  std::uint64_t final_tests = 0;           ///< rays with triangles
  double packet_seconds = 0;               ///< frusta
  double traverse_seconds = 0;             ///< frusta with boxes
  double final_seconds = 0;                ///< frusta with triangles, rays with triangles
};

/// `rays` in the order that `packets` were cut from; `best[i]` takes the hits of rays[i]. Where
/// `ray_tests` is not empty, ray_tests[i] grows by the tests of ray i: its own, and its share of
/// those of its packet. `meter` advances by packets. The same hits and counts with any number of
/// threads and any capacity.
PacketCounts traverse_packets(const Executor& executor, const FlatScene& scene, const Bvh& bvh,
                              View<const Packet> packets, View<const Ray> rays,
                              const PacketOptions& options, View<RayHit> best,
                              View<float> ray_tests, ProgressMeter* meter);

}  // namespace raysheaf
