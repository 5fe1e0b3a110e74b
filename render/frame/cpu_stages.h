// The stages of a frame on the CPU, for every storage of the triangles.
#pragma once

#include "render/device/frame_stages.h"
#include "render/frame/frame.h"
#include "render/rays/raygen.h"

namespace raysheaf {

/// All must outlive the result. `keys`: whether the method orders rays by keys.
[[nodiscard]] std::unique_ptr<FrameStages> make_cpu_stages(const Executor& executor,
                                                           const FrameInput& input, Keys keys,
                                                           FrameTally* tally, ProgressMeter* meter);

}  // namespace raysheaf
