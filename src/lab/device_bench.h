// The measurements of raysheaf/device_bench.h on a machine that is handed in.
#pragma once

#include "engine/device_engine.h"
#include "raysheaf/device_bench.h"

namespace raysheaf {

[[nodiscard]] DeviceBenchReport bench_device_on(const DeviceBackend& backend,
                                                const SceneDescription& scene,
                                                const DeviceBenchOptions& options);

}  // namespace raysheaf
