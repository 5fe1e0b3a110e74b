// Cuts ordered rays into packets (Garanzha & Loop 2010, "Fast Ray Sorting and Breadth-First Packet
// Traversal for GPU Ray Tracing": sorted rays are decomposed into packets by their keys).
//
// The keys of `crsh` are positions along space-filling curves, finer than a packet: a run of equal
// keys holds a few rays. Therefore a packet takes a whole cell of the curve, that is all rays whose
// keys share their upper bits. The cell is the largest one with at most `most_rays`:
//
//   key   0000 0001 0001 0010 | 0100 0101 0110 0111 | 1000 1000 1001 | 1110
//         ------ 00.. ------    ------ 01.. ------    ---- 10.. ---    11..
//
// If more rays have the same key, they are cut into equal parts. Finally, a packet whose rays do
// not all have the same dominant axis and sense is split by axis and sense.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "base/view.h"
#include "exec/executor.h"

namespace raysheaf {

inline constexpr std::uint32_t kPacketRays = 256;

/// Rays [first, first + count) of the ordered rays.
struct Packet {
  std::uint32_t first = 0, count = 0;
};

/// The dominant axis of a direction times two, plus 1 if the direction points down that axis.
RAYSHEAF_HD inline std::uint32_t dominant_sense(Vec3 d) {
  const Vec3 m = abs(d);
  const int axis = m.x > m.y ? (m.x > m.z ? 0 : 2) : (m.y > m.z ? 1 : 2);
  return 2 * static_cast<std::uint32_t>(axis) + (component(d, axis) < 0 ? 1u : 0u);
}

/// `order[i]` is the ray at place i. `sorted_keys[i]` is its key, ascending in the low `key_bits`
/// bits; without keys, packets are runs of `most_rays`. Splitting a packet moves its rays: `order`
/// stays a permutation, and rays of one sense keep their order. O(rays) work; the cuts by key are
/// O(packets log rays) on one thread.
[[nodiscard]] std::vector<Packet> make_packets(const Executor& executor, View<const Ray> rays,
                                               View<const std::uint32_t> sorted_keys,
                                               std::uint32_t key_bits, std::uint32_t most_rays,
                                               View<std::uint32_t> order);

}  // namespace raysheaf
