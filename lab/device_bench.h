// The measurements of raysheaf/device_bench.h on a given device.
#pragma once

#include "device/backend.h"
#include "raysheaf/device_bench.h"

namespace raysheaf {

/// The requested kinds of rays, or all if none is named.
[[nodiscard]] std::vector<LabRays> kinds_of_rays(const DeviceBenchOptions& options);

[[nodiscard]] DeviceBenchReport bench_device_on(const DeviceBackend& backend,
                                                const SceneDescription& scene,
                                                const DeviceBenchOptions& options);

}  // namespace raysheaf
