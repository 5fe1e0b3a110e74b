// The laboratory's own batches, which rendering does not use: every surface is a mirror, and light
// comes from everywhere.
#pragma once

#include "render/rays/raygen.h"

namespace raysheaf {

inline constexpr std::uint32_t kOcclusionRays = 4;  ///< per fragment

/// One ray for each fragment that has a surface, reflected at the shading normal as in
/// `mirror_direction`. Slot: the fragment.
[[nodiscard]] RayBatch make_mirror_rays(const Executor& executor, View<const Fragment> fragments,
                                        const Box& scene_bounds, std::uint32_t bounce);

/// `kOcclusionRays` for each fragment that has a surface, `length` long, cosine-distributed around
/// the shading normal: one in each quarter of the unit square, jittered by a hash of the pixel, so
/// that the batch is the same on every machine. Slot: sample * fragments + fragment.
[[nodiscard]] RayBatch make_occlusion_rays(const Executor& executor, View<const Fragment> fragments,
                                           const Box& scene_bounds, float length);

}  // namespace raysheaf
