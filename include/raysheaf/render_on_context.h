// The renderer on a context: its threads, and its device for rays and triangles.
#pragma once

#include "raysheaf/context.h"
#include "raysheaf/render.h"

namespace raysheaf {

/// As `render(scene, options)`, and the same picture; `options.threads` is not used. On
/// Device::kCuda rays meet triangles there, by every method but `gl10` (docs/cuda.md); all else is
/// the CPU's. Throws `Error`: as that; kUnsupported for what the device does not know.
[[nodiscard]] RenderResult render(const Context& context, const SceneDescription& scene,
                                  const RenderOptions& options = {});

}  // namespace raysheaf
