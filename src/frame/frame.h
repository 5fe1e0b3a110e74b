// The loop over the stages: one frame.
#pragma once

#include "engine/device_engine.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "frame/primary.h"
#include "raysheaf/render.h"
#include "scene/environment_body.h"
#include "scene/flat_scene.h"
#include "scene/texture.h"

namespace raysheaf {

/// What a frame is made of. Without a rasteriser primary visibility is traced, as a lens needs it;
/// without a cache nothing is kept of this scene.
struct FrameInput {
  const FlatScene& scene;
  const TextureSet& textures;
  const Camera& camera;
  View<const Light> lights;
  const RenderOptions& options;
  std::uint32_t samples = 1;
  Rasterizer* rasterizer = nullptr;
  const EnvironmentView* environment = nullptr;  ///< none: a uniform sky
  TraceCache* cache = nullptr;
};

[[nodiscard]] RenderResult render_frame(const Executor& executor, const FrameInput& input,
                                        ProgressMeter* meter);

}  // namespace raysheaf
