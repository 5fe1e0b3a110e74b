// Traverses a hierarchy over the triangles with packets, level by level, and makes the final tests
// (Garanzha & Loop 2010, "Fast Ray Sorting and Breadth-First Packet Traversal for GPU Ray
// Tracing").
//
//   queue of depth d      (packet, node) ...          sorted by packet
//      | the packet's frustum with the boxes of the node's children, all pairs in parallel
//      | survivors compacted, by scans
//      v
//   queue of depth d + 1  (packet, node) ...    and   leaves  (packet, leaf) ...
//
// When the queue is empty, each packet processes its leaves: it tests the frustum with their
// triangles one by one, then its rays with the remaining triangles, near ones first. A ray skips
// triangles that begin behind its hit.
//
// Packets are processed in batches. A batch whose queue or leaves exceed the capacity is repeated
// with half the packets, so nothing is lost; one packet always fits, because the capacity is at
// least the number of nodes and of leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "paper/base/level_counts.h"
#include "paper/base/triangle_view.h"
#include "paper/packets/bvh.h"
#include "paper/packets/packets.h"

namespace raysheaf {

inline constexpr std::uint32_t kPairCapacity = 1u << 18;

struct PacketOptions {
  bool early_out = false;  ///< rays are not tested after their first hit
  Facing facing = Facing::kBoth;
  std::uint32_t pair_capacity = kPairCapacity;
};

/// Frustum tests by level: level 1 is the triangles of leaves, level 2 the boxes in the deepest
/// nodes, and so on to the boxes in the root.
struct PacketCounts : LevelCounts {
  double packet_seconds = 0;    ///< computing frusta
  double traverse_seconds = 0;  ///< tests of frusta with boxes
  double final_seconds = 0;     ///< tests of frusta with triangles, and of rays with triangles
};

/// `rays` in the order from which `packets` were cut; `best[i]` receives the hit of rays[i]. If
/// `ray_tests` is not empty, the tests of ray i are added to ray_tests[i]: its own, and its share
/// of its packet's. `meter` advances by packets. Hits and counts are the same with any number of
/// threads and any capacity.
PacketCounts traverse_packets(const Executor& executor, const TriangleView& triangles,
                              const Bvh& bvh, View<const Packet> packets, View<const Ray> rays,
                              const PacketOptions& options, View<RayHit> best,
                              View<float> ray_tests, ProgressMeter* meter);

}  // namespace raysheaf
