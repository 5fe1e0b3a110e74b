// Stage 3 begins: a sort key for each ray of a batch, of any kind that RayKey names.
//
// What a key is made of stands in rays/key_body.h, the published program's in
// rays/published_body.h, that of `crsh` in rays/hash_body.h. Compared in docs/keys.md.
#pragma once

#include <cstdint>
#include <vector>

#include "rays/raygen.h"
#include "raysheaf/method.h"

namespace raysheaf {

/// A key for each ray, in the batch's order; all are below 2^*used_bits.
///
/// `key_bits` is 32 or 64. Keys of `published`, `corrected` and `crsh` have 32 bits at most however
/// many are allowed, and `raster` gives zeros of no bits. All others hold a shadow ray's light
/// above everything else. O(rays).
[[nodiscard]] std::vector<std::uint64_t> make_keys(const Executor& executor, const RayBatch& batch,
                                                   RayKey key, std::uint32_t key_bits,
                                                   const Box& scene_bounds,
                                                   std::uint32_t* used_bits);

}  // namespace raysheaf
