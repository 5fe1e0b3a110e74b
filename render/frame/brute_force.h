// Tests every ray with every triangle: the ground truth, and `--method brute`.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "scene/triangle_source.h"

namespace raysheaf {

/// best[i] receives the hit of rays[i]. N * M tests. `meter` advances by rays.
void intersect_brute_force(const Executor& executor, const TriangleSource& triangles,
                           View<const Ray> rays, Facing facing, View<RayHit> best,
                           ProgressMeter* meter);

}  // namespace raysheaf
