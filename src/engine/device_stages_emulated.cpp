#include "engine/device_stages-inl.h"
#include "exec/cpu/emulated_device.h"
#include "exec/cpu/emulated_gl.h"
#include "exec/cpu/emulated_links.h"

namespace raysheaf {

std::unique_ptr<DeviceStages> make_emulated_stages(const Executor& executor, HostAllocator& memory,
                                                   DeviceAllocator* allocator) {
  return std::make_unique<DeviceStagesOn<EmulatedDevice>>(executor, memory, allocator);
}

}  // namespace raysheaf
