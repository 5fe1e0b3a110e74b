#include "emulated/open_emulated.h"

#include "backends/backend_device.h"
#include "emulated/emulated_gl.h"
#include "emulated/emulated_links.h"

namespace raysheaf {

std::unique_ptr<DeviceBackend> open_emulated(const Executor& executor, HostAllocator& memory,
                                             DeviceAllocator* allocator) {
  using Backend = BackendOn<EmulatedDevice, const Executor&, HostAllocator&, DeviceAllocator*>;
  return std::make_unique<Backend>(executor, memory, allocator);
}

std::unique_ptr<PairTracer> make_emulated_pair_tracer(std::uint32_t capacity,
                                                      const Executor& executor,
                                                      HostAllocator& memory,
                                                      DeviceAllocator* allocator) {
  return std::make_unique<PairTracerOn<EmulatedDevice>>(capacity, executor, memory, allocator);
}
std::unique_ptr<PacketTracer> make_emulated_packet_tracer(std::uint32_t capacity,
                                                          const Executor& executor,
                                                          HostAllocator& memory,
                                                          DeviceAllocator* allocator) {
  return std::make_unique<PacketTracerOn<EmulatedDevice>>(capacity, executor, memory, allocator);
}

}  // namespace raysheaf
