#include "engine/block_tracer-inl.h"
#include "exec/cuda/cuda_links.h"
#include "exec/cuda/launch-inl.h"

namespace raysheaf {

std::unique_ptr<BlockTracer> make_cuda_block_tracer(const Executor& executor,
                                                    const BlockLimits& limits) {
  return std::make_unique<BlockTracerOn<CudaDevice>>(executor, limits);
}

}  // namespace raysheaf
