// Stage 3, first part: a sort key for each ray of a batch, of any RayKey.
//
// paper/order/key_body.h defines the keys, paper/order/published_body.h that of the published
// program, and render/rays/hash_body.h that of `crsh`. docs/keys.md compares them.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/method.h"
#include "render/rays/raygen.h"

namespace raysheaf {

/// A key for each ray, in the batch's order; all are below 2^*used_bits.
///
/// `key_bits` is 32 or 64. Keys of `published`, `corrected` and `crsh` have at most 32 bits even if
/// more are allowed, and `raster` gives zeros of no bits. All others hold a shadow ray's light in
/// the upper bits. O(rays).
[[nodiscard]] std::vector<std::uint64_t> make_keys(const Executor& executor, const RayBatch& batch,
                                                   RayKey key, std::uint32_t key_bits,
                                                   const Box& scene_bounds,
                                                   std::uint32_t* used_bits);

}  // namespace raysheaf
