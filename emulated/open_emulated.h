// Opens the CPU as an emulated device, for tests and counts.
#pragma once

#include <memory>

#include "device/backend.h"
#include "emulated/emulated_device.h"

namespace raysheaf {

/// The CPU emulating a device (emulated/emulated_device.h), with `memory` as the device's memory,
/// from which `allocator`, if given, allocates.
[[nodiscard]] std::unique_ptr<DeviceBackend> open_emulated(const Executor& executor,
                                                           HostAllocator& memory,
                                                           DeviceAllocator* allocator = nullptr);

}  // namespace raysheaf
