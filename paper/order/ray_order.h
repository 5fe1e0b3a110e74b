// Stage 3: the order of a batch's rays by a method's keys.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/method.h"
#include "render/rays/raygen.h"

namespace raysheaf {

/// The stable order of the rays by the method's keys; adds the number of runs of equal keys to
/// `statistics`.
[[nodiscard]] std::vector<std::uint32_t> ray_order(const Executor& executor, const RayBatch& batch,
                                                   const Box& scene_bounds,
                                                   const MethodSettings& method,
                                                   BatchStatistics* statistics);

}  // namespace raysheaf
