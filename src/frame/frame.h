// The loop over the stages: one frame.
#pragma once

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "frame/geometry.h"
#include "raysheaf/render.h"

namespace raysheaf {

/// What a frame is made of. `rasterizer` may be null where primary visibility is traced.
struct FrameInput {
  FrameGeometry& geometry;
  const Camera& camera;
  View<const Light> lights;
  const RenderOptions& options;
  Rasterizer* rasterizer = nullptr;
};

/// The method's settings with what was asked for in their place.
[[nodiscard]] MethodSettings settings_for(const RenderOptions& options);

[[nodiscard]] RenderResult render_frame(const Executor& executor, const FrameInput& input,
                                        ProgressMeter* meter);

}  // namespace raysheaf
