// The published program's algorithm, to the count: what it tested, not what it hit.
#pragma once

#include "exec/executor.h"
#include "rays/raygen.h"
#include "raysheaf/lab.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// The shape of the published hierarchy; its logs hold others too.
struct PublishedShape {
  std::uint32_t levels = 2, branching = 8;
};

/// Counts of `rah`, or of `crsh` where so. Final tests are counted, not executed.
/// `width`: of the picture whose pixels the rays belong to.
[[nodiscard]] BatchStatistics count_as_published(const Executor& executor, const FlatScene& scene,
                                                 const RayBatch& batch, Method method,
                                                 const Quirks& quirks, std::uint32_t width,
                                                 PublishedShape shape = {});

}  // namespace raysheaf
