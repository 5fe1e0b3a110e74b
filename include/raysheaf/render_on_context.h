// The renderer on a context: its threads, and its device for rays and triangles.
#pragma once

#include "raysheaf/context.h"
#include "raysheaf/render.h"

namespace raysheaf {

/// As `render(scene, options)`, and the same picture; `options.threads` is not used. With
/// Device::kCuda it is made there, from the first hits on (docs/cuda.md). Throws `Error`: as that;
/// kUnsupported for what the device does not know.
[[nodiscard]] RenderResult render(const Context& context, const SceneDescription& scene,
                                  const RenderOptions& options = {});

}  // namespace raysheaf
