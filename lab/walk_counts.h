// What the threads of a device do on their way down the object tree, counted on the CPU.
//
// The 32 threads of a warp run in lock step. In a turn of the loop of `walk_tree`
// (methods/dual/tree_walk_body.h) each visits one node or one leaf, so a warp turns as often as the
// busiest of its rays.
#pragma once

#include "base/view.h"
#include "emulated/emulated_device.h"
#include "object_tree/triangle_list.h"
#include "raysheaf/device_bench.h"

namespace raysheaf {

inline constexpr std::size_t kWarpThreads = 32;

/// The largest of each `kWarpThreads` in a row, summed.
[[nodiscard]] std::uint64_t warp_turns(View<const std::uint32_t> turns_of_threads);

/// Counts how `rays` walk down the tree that `LinearTree` builds over `list`. `any`: until any hit,
/// or else to the closest. Fills all but `rays` of the result.
[[nodiscard]] DeviceWalks count_walks_on(EmulatedDevice& device, const TriangleList& list,
                                         View<const Ray> rays, bool any);

}  // namespace raysheaf
