// Method `gl10` on a device: packets of ordered rays against the hierarchy over the triangles,
// level by level, as lists of (packet, node) pairs; then their leaves (packet/packet_traverse.h).
// The same hits, and the counts of the CPU, test for test.
//
// Packets and hierarchy come from the host. Packets go in batches, as there, so that no list
// overflows.
#pragma once

#include <memory>

#include "engine/engine.h"
#include "exec/cpu/emulated_device.h"
#include "packet/packet_traverse.h"

namespace raysheaf {

/// A scene as the CPU has it; copied.
struct PacketScene {
  View<const Vec3> corners;  ///< three a triangle
  View<const std::uint8_t> flags;
  Box bounds;
  const Bvh& bvh;
};

/// Of `options.pair_capacity`, the tracer's own stands in its place.
struct PacketBatch {
  View<const Ray> rays;  ///< in the order that the packets were cut from
  View<const Packet> packets;
  PacketOptions options;
};

/// One scene's, on one device. Not for use by two threads at once.
class PacketTracer {
 public:
  virtual ~PacketTracer() = default;
  virtual void set_scene(const PacketScene& scene) = 0;
  /// best[i] takes the least (t, triangle) of rays[i]. All in the host's memory.
  virtual PacketCounts trace(const PacketBatch& batch, View<RayHit> best) = 0;
};

/// On the first CUDA device; errors as `open_cuda`. `capacity`: of each list of pairs.
[[nodiscard]] std::unique_ptr<PacketTracer> make_cuda_packet_tracer(std::uint32_t capacity);
/// As `open_emulated`.
[[nodiscard]] std::unique_ptr<PacketTracer> make_emulated_packet_tracer(
    std::uint32_t capacity, const Executor& executor, HostAllocator& memory,
    DeviceAllocator* allocator = nullptr);

}  // namespace raysheaf
