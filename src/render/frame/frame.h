// The loop over the stages: one frame.
#pragma once

#include <functional>

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "raysheaf/distributed.h"
#include "raysheaf/render.h"
#include "render/device/frame_stages.h"
#include "render/frame/geometry.h"
#include "surface/environment_body.h"

namespace raysheaf {

/// What a frame is made of. Without a rasteriser primary visibility is traced, as a lens needs it.
struct FrameInput {
  FrameGeometry& geometry;
  const Camera& camera;
  View<const PlacedLight> lights;
  const RenderOptions& options;
  std::uint32_t samples = 1;
  Rasterizer* rasterizer = nullptr;
  const EnvironmentView* environment = nullptr;  ///< none: a uniform sky
  /// Puts into statistics what is not the frame's to know: names, sizes, the time so far.
  std::function<void(FrameStatistics*)> complete = nullptr;
  DeviceStages* device = nullptr;   ///< with the scene, where fragments are a device's
  Rasterize rasterize = nullptr;    ///< of its frames, where not by rays
  PairTracer* pairs = nullptr;      ///< where the device and the method have one
  PacketTracer* packets = nullptr;  ///< the same
  /// Who else makes the frame, where groups of first hits are followed one by one, or by a device;
  /// null: nobody.
  Communicator* ranks = nullptr;
};

/// The method's settings with what was asked for in their place.
[[nodiscard]] MethodSettings settings_for(const RenderOptions& options);

/// Tells `options.progress` how far it is.
[[nodiscard]] RenderResult render_frame(const Executor& executor, const FrameInput& input);

}  // namespace raysheaf
