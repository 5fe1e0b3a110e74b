// The stages of a frame on the CPU; triangles are wherever their geometry has them.
#pragma once

#include "engine/frame_stages.h"
#include "frame/frame.h"
#include "raygen/raygen.h"

namespace raysheaf {

/// All outlive what is made. `keys`: whether the method brings rays together by keys of theirs.
[[nodiscard]] std::unique_ptr<FrameStages> make_cpu_stages(const Executor& executor,
                                                           const FrameInput& input, Keys keys,
                                                           FrameTally* tally, ProgressMeter* meter);

}  // namespace raysheaf
