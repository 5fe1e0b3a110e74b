#include "backends/cuda.h"
#include "exec/cuda/cuda_launch.h"
#include "methods/ray_hierarchy/pair_tracer_device.h"

namespace raysheaf {

std::unique_ptr<PairTracer> make_cuda_pair_tracer(std::uint32_t capacity) {
  return std::make_unique<PairTracerOn<CudaDevice>>(capacity);
}

}  // namespace raysheaf
