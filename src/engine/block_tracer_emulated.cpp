#include "engine/block_tracer-inl.h"
#include "exec/cpu/emulated_links.h"

namespace raysheaf {

std::unique_ptr<BlockTracer> make_emulated_block_tracer(const Executor& executor,
                                                        const BlockLimits& limits,
                                                        HostAllocator& memory,
                                                        DeviceAllocator* allocator) {
  return std::make_unique<BlockTracerOn<EmulatedDevice>>(executor, limits, executor, memory,
                                                         allocator);
}

}  // namespace raysheaf
