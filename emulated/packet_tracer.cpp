#include "emulated/emulated_device.h"
#include "emulated/open_emulated.h"
#include "methods/packets/packet_tracer_device.h"

namespace raysheaf {

std::unique_ptr<PacketTracer> make_emulated_packet_tracer(std::uint32_t capacity,
                                                          const Executor& executor,
                                                          HostAllocator& memory,
                                                          DeviceAllocator* allocator) {
  return std::make_unique<PacketTracerOn<EmulatedDevice>>(capacity, executor, memory, allocator);
}

}  // namespace raysheaf
