#include "emulated/emulated_device.h"
#include "emulated/emulated_gl.h"
#include "emulated/emulated_links.h"
#include "emulated/open_emulated.h"
#include "render/device/stages_device.h"

namespace raysheaf {

std::unique_ptr<DeviceStages> make_emulated_stages(const Executor& executor, HostAllocator& memory,
                                                   DeviceAllocator* allocator) {
  return std::make_unique<DeviceStagesOn<EmulatedDevice>>(executor, memory, allocator);
}

}  // namespace raysheaf
