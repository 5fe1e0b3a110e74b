#include "backends/cuda.h"
#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_links.h"
#include "out_of_core/block_tracer_device.h"

namespace raysheaf {

std::unique_ptr<BlockTracer> make_cuda_block_tracer(const Executor& executor,
                                                    const BlockLimits& limits) {
  return std::make_unique<BlockTracerOn<CudaDevice>>(executor, limits);
}

}  // namespace raysheaf
