// Tests every ray with every triangle: the ground truth, and `--method brute`.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "intersect/triangle_view.h"

namespace raysheaf {

/// best[i] receives the hit of rays[i]. N * M tests. `meter` advances by rays.
void intersect_brute_force(const Executor& executor, const TriangleView& triangles,
                           View<const Ray> rays, Facing facing, View<RayHit> best,
                           ProgressMeter* meter);

/// A run of a scene's triangles in the kernels' format.
[[nodiscard]] TriangleArrays triangle_run(const TriangleView& triangles, std::uint32_t first,
                                          std::uint32_t count);

}  // namespace raysheaf
