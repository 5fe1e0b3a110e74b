#include "exec/cuda/cuda_launch.h"
#include "paper/make_tracers.h"
#include "paper/packets/packet_tracer_device.h"
#include "paper/ray_hierarchy/pair_tracer_device.h"

namespace raysheaf {

std::unique_ptr<DeviceBatchTracer> make_cuda_batch_tracer(Traversal traversal) {
  if (traversal == Traversal::kPackets)
    return std::make_unique<PacketTracerOn<CudaDevice>>(kPairCapacity, kPacketRays);
  return std::make_unique<PairTracerOn<CudaDevice>>(kPairListCapacity);
}

}  // namespace raysheaf
