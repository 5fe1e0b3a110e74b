#include "emulated/emulated_links.h"
#include "emulated/open_emulated.h"
#include "out_of_core/block_tracer_device.h"

namespace raysheaf {

std::unique_ptr<BlockTracer> make_emulated_block_tracer(const Executor& executor,
                                                        const BlockLimits& limits,
                                                        HostAllocator& memory,
                                                        DeviceAllocator* allocator) {
  return std::make_unique<BlockTracerOn<EmulatedDevice>>(executor, limits, executor, memory,
                                                         allocator);
}

}  // namespace raysheaf
