// Renders one frame: the loop over the stages.
#pragma once

#include <functional>

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "raysheaf/distributed.h"
#include "raysheaf/render.h"
#include "render/device/frame_stages.h"
#include "render/frame/geometry.h"
#include "render/surface/environment_body.h"

namespace raysheaf {

/// The input of a frame. Without a rasterizer, primary rays are traced, as a lens requires.
struct FrameInput {
  FrameGeometry& geometry;
  const Camera& camera;
  View<const PlacedLight> lights;
  const RenderOptions& options;
  std::uint32_t samples = 1;
  Rasterizer* rasterizer = nullptr;
  const EnvironmentView* environment = nullptr;  ///< null: a uniform sky
  /// Completes the statistics with what the frame does not know: names, sizes, the time so far.
  std::function<void(FrameStatistics*)> complete = nullptr;
  StudioRoom room = {};            ///< in reflections and refractions, in place of a uniform sky
  DeviceStages* device = nullptr;  ///< with the scene, if fragments are on a device
  Rasterize rasterize = nullptr;   ///< of its frames, unless primary rays are traced
  DeviceBatchTracer* ordered = nullptr;  ///< if the device and the method have one
  /// The processes that share the frame, if groups of primary hits are followed independently or by
  /// a device; null: this is the only one.
  Communicator* ranks = nullptr;
};

/// Reports progress to `options.progress`.
[[nodiscard]] RenderResult render_frame(const Executor& executor, const FrameInput& input);

}  // namespace raysheaf
