// The loop over the stages: one frame.
#pragma once

#include "engine/device_engine.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "frame/primary.h"
#include "raysheaf/render.h"
#include "scene/flat_scene.h"
#include "scene/texture.h"

namespace raysheaf {

/// What a frame is made of. `rasterizer` may be null where primary visibility is traced.
struct FrameInput {
  const FlatScene& scene;
  const TextureSet& textures;
  const Camera& camera;
  View<const Light> lights;
  const RenderOptions& options;
  Rasterizer* rasterizer = nullptr;
  const DeviceBackend* backend = nullptr;  ///< where rays meet triangles; null: on the CPU
};

[[nodiscard]] RenderResult render_frame(const Executor& executor, const FrameInput& input,
                                        ProgressMeter* meter);

}  // namespace raysheaf
