#include "emulated/emulated_device.h"
#include "emulated/open_emulated.h"
#include "methods/ray_hierarchy/pair_tracer_device.h"

namespace raysheaf {

std::unique_ptr<PairTracer> make_emulated_pair_tracer(std::uint32_t capacity,
                                                      const Executor& executor,
                                                      HostAllocator& memory,
                                                      DeviceAllocator* allocator) {
  return std::make_unique<PairTracerOn<EmulatedDevice>>(capacity, executor, memory, allocator);
}

}  // namespace raysheaf
