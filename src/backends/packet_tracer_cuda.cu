#include "backends/cuda.h"
#include "exec/cuda/cuda_launch.h"
#include "methods/packets/packet_tracer_device.h"

namespace raysheaf {

std::unique_ptr<PacketTracer> make_cuda_packet_tracer(std::uint32_t capacity) {
  return std::make_unique<PacketTracerOn<CudaDevice>>(capacity);
}

}  // namespace raysheaf
