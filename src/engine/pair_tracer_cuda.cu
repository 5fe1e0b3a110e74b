#include "engine/pair_tracer-inl.h"
#include "exec/cuda/launch-inl.h"

namespace raysheaf {

std::unique_ptr<PairTracer> make_cuda_pair_tracer(std::uint32_t capacity) {
  return std::make_unique<PairTracerOn<CudaDevice>>(capacity);
}

}  // namespace raysheaf
