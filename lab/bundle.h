// The bundles of a method and their bounds, for display.
#pragma once

#include "exec/executor.h"
#include "raysheaf/lab.h"
#include "render/rays/raygen.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// The bundle of ray number `ray` of a batch, as `trace` (render/frame/trace.h) would make it. Rays
/// are sorted and bounded as there, so it takes as long as tracing without its tests.
[[nodiscard]] RayBundle find_bundle(const Executor& executor, const FlatScene& scene,
                                    const RayBatch& batch, std::size_t ray,
                                    const MethodSettings& settings);

}  // namespace raysheaf
