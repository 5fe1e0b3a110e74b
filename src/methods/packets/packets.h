// Ordered rays cut into packets (Garanzha & Loop 2010, "Fast Ray Sorting and Breadth-First Packet
// Traversal for GPU Ray Tracing": sorted rays are decomposed into packets by their keys).
//
// The keys of `crsh` are places along space-filling curves, finer than a packet: a run of equal
// keys holds a few rays. So a packet takes a whole cell of the curve, all rays whose keys share
// their upper bits, as large a cell as has at most `most_rays`:
//
//   key   0000 0001 0001 0010 | 0100 0101 0110 0111 | 1000 1000 1001 | 1110
//         ------ 00.. ------    ------ 01.. ------    ---- 10.. ---    11..
//
// Rays of one key that are more than that are cut into equal parts. Then a packet whose rays do not
// all run mostly along the same axis, in the same sense, is parted by axis and sense.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "base/view.h"
#include "exec/executor.h"

namespace raysheaf {

inline constexpr std::uint32_t kPacketRays = 256;

/// Rays [first, first + count) of the ordered ones.
struct Packet {
  std::uint32_t first = 0, count = 0;
};

/// The axis along which a direction runs mostly, twice, plus 1 where it runs down.
RAYSHEAF_HD inline std::uint32_t dominant_sense(Vec3 d) {
  const Vec3 m = abs(d);
  const int axis = m.x > m.y ? (m.x > m.z ? 0 : 2) : (m.y > m.z ? 1 : 2);
  return 2 * static_cast<std::uint32_t>(axis) + (component(d, axis) < 0 ? 1u : 0u);
}

/// `order[i]` is the ray at place i. `sorted_keys[i]` is its key, ascending in the low `key_bits`
/// bits; where there are no keys, packets are runs of `most_rays`. Parting a packet moves its
/// rays: `order` stays a permutation, and rays of one sense keep their order. O(rays) work; the
/// cuts by key are O(packets log rays) on one thread.
[[nodiscard]] std::vector<Packet> make_packets(const Executor& executor, View<const Ray> rays,
                                               View<const std::uint32_t> sorted_keys,
                                               std::uint32_t key_bits, std::uint32_t most_rays,
                                               View<std::uint32_t> order);

}  // namespace raysheaf
