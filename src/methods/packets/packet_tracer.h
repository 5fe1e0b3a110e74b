// The method `gl10` on a device: rays are ordered by their keys and cut into packets. The packets
// traverse the hierarchy over the triangles, level by level, as lists of (packet, node) pairs, and
// then their leaves (methods/packets/packet_traverse.h). The hierarchy is the CPU's, which builds
// it (methods/packets/bvh.h). Hits and counts are those of the CPU, test for test.
//
// As on the CPU, packets are processed in batches, so that no list overflows.
#pragma once

#include <memory>

#include "methods/packets/packet_traverse.h"
#include "object_tree/triangle_list.h"
#include "queries/query_report.h"

namespace raysheaf {

struct PacketScene {
  TriangleList triangles;  ///< used in place if in the device's memory, copied if in the host's
  Box bounds;
};

struct PacketQuery {
  std::uint32_t most_rays = kPacketRays;  ///< per packet
  bool early_out = false;                 ///< rays are not tested after their first hit
  Facing facing = Facing::kBoth;
  std::uint32_t key_bits = 32;
  QueryReport* report = nullptr;
};

struct PacketOutcome {
  PacketCounts counts;       ///< without times
  std::uint64_t chunks = 0;  ///< runs of equal keys
};

/// The tracer of one scene on one device. Not for two threads at once.
class PacketTracer {
 public:
  virtual ~PacketTracer() = default;
  /// Builds the hierarchy on the CPU and copies it to the device.
  virtual void set_scene(const Executor& executor, const PacketScene& scene) = 0;
  /// hits[i] receives the hit of rays[i] with the least (t, triangle). `keys`: the sort keys of the
  /// rays, whose cells become packets; empty: packets are runs of rays in the given order. Each
  /// array may be in the host's or the device's memory; the work that writes it must be complete.
  virtual PacketOutcome trace(View<const Ray> rays, View<const std::uint32_t> keys,
                              const PacketQuery& query, View<IndexedHit> hits) = 0;
};

}  // namespace raysheaf
