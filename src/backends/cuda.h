// Opens the CUDA device.
#pragma once

#include <memory>

#include "device/backend.h"

namespace raysheaf {

/// The first CUDA device. Throws Error (kUnsupported) if this build has no CUDA or, with CUDA's
/// message, if the machine has no usable device. Its queries and tracers throw the same errors.
[[nodiscard]] std::unique_ptr<DeviceBackend> open_cuda();

}  // namespace raysheaf
