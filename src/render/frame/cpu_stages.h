// The stages of a frame on the CPU; triangles are wherever their geometry has them.
#pragma once

#include "rays/raygen.h"
#include "render/device/frame_stages.h"
#include "render/frame/frame.h"

namespace raysheaf {

/// All outlive what is made. `keys`: whether the method brings rays together by keys of theirs.
[[nodiscard]] std::unique_ptr<FrameStages> make_cpu_stages(const Executor& executor,
                                                           const FrameInput& input, Keys keys,
                                                           FrameTally* tally, ProgressMeter* meter);

}  // namespace raysheaf
