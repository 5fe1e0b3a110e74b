#include "engine/packet_tracer-inl.h"
#include "exec/cuda/launch-inl.h"

namespace raysheaf {

std::unique_ptr<PacketTracer> make_cuda_packet_tracer(std::uint32_t capacity) {
  return std::make_unique<PacketTracerOn<CudaDevice>>(capacity);
}

}  // namespace raysheaf
