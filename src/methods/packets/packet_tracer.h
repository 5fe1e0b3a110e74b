// Method `gl10` on a device: rays are ordered by their keys and cut into packets; these meet the
// hierarchy over the triangles, level by level, as lists of (packet, node) pairs; then their leaves
// (methods/packets/packet_traverse.h). The same hits, and the counts of the CPU, test for test.
//
// The hierarchy comes from the host. Packets go in batches, as there, so that no list overflows.
#pragma once

#include <memory>

#include "methods/packets/packet_traverse.h"
#include "object_tree/triangle_list.h"
#include "queries/query_report.h"

namespace raysheaf {

struct PacketScene {
  TriangleList triangles;  ///< in the device's memory, where they stay as they are, or the host's
  Box bounds;
  const Bvh& bvh;  ///< copied
};

struct PacketQuery {
  std::uint32_t most_rays = kPacketRays;  ///< of a packet
  bool early_out = false;                 ///< rays that met something are tested no more
  Facing facing = Facing::kBoth;
  std::uint32_t key_bits = 32;
  QueryReport* report = nullptr;
};

struct PacketOutcome {
  PacketCounts counts;       ///< without seconds
  std::uint64_t chunks = 0;  ///< runs of equal keys
};

/// One scene's, on one device. Not for use by two threads at once.
class PacketTracer {
 public:
  virtual ~PacketTracer() = default;
  virtual void set_scene(const PacketScene& scene) = 0;
  /// hits[i] takes the least (t, triangle) of rays[i]. `keys`: what the rays are sorted by and
  /// packets are cells of; empty: packets are runs of rays as they are. Each in the host's memory
  /// or the device's, where what writes it is done.
  virtual PacketOutcome trace(View<const Ray> rays, View<const std::uint32_t> keys,
                              const PacketQuery& query, View<IndexedHit> hits) = 0;
};

}  // namespace raysheaf
