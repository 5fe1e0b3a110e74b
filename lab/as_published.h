// The published program's algorithm, reproduced to the exact number of tests; hits are not
// computed.
#pragma once

#include "exec/executor.h"
#include "raysheaf/lab.h"
#include "render/rays/raygen.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// The shape of the published hierarchy; its logs also have others.
struct PublishedShape {
  std::uint32_t levels = 2, branching = 8;
};

/// Counts of `rah` or `crsh`. Final tests are counted, not executed. `width`: of the image to whose
/// pixels the rays belong.
[[nodiscard]] BatchStatistics count_as_published(const Executor& executor, const FlatScene& scene,
                                                 const RayBatch& batch, Method method,
                                                 const Quirks& quirks, std::uint32_t width,
                                                 PublishedShape shape = {});

}  // namespace raysheaf
