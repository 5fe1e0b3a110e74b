// The renderer on a context: its threads, and its device for rays and triangles.
#pragma once

#include "raysheaf/context.h"
#include "raysheaf/render.h"

namespace raysheaf {

/// Renders the same image as `render(scene, options)`; ignores `options.threads`. With
/// Device::kCuda the device renders everything after primary visibility (docs/cuda.md). Throws
/// `Error` as that function, and kUnsupported for features that the device does not support.
[[nodiscard]] RenderResult render(const Context& context, const SceneDescription& scene,
                                  const RenderOptions& options = {});

}  // namespace raysheaf
