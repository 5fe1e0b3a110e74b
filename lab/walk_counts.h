// The work of a device's threads during their traversal of the object tree, counted on the CPU.
//
// The 32 threads of a warp run in lock step. In an iteration of the loop of `walk_tree`
// (device/tree_walk_body.h) each visits one node or one leaf, so a warp iterates as often as
// the ray with the most iterations.
#pragma once

#include "base/view.h"
#include "emulated/emulated_device.h"
#include "object_tree/triangle_list.h"
#include "raysheaf/device_bench.h"

namespace raysheaf {

inline constexpr std::size_t kWarpThreads = 32;

/// The sum of the maximum over each `kWarpThreads` consecutive threads.
[[nodiscard]] std::uint64_t warp_turns(View<const std::uint32_t> turns_of_threads);

/// Counts how `rays` traverse the tree that `LinearTree` builds over `list`. `any`: until any hit,
/// otherwise to the closest. Fills all fields of the result except `rays`.
[[nodiscard]] DeviceWalks count_walks_on(EmulatedDevice& device, const TriangleList& list,
                                         View<const Ray> rays, bool any);

}  // namespace raysheaf
