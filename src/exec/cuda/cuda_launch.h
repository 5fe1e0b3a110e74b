// `for_each` as a kernel launch; for CUDA sources.
#pragma once

#include "exec/cuda/cuda_device_templates.h"

namespace raysheaf {

/// Minimum resident blocks per multiprocessor, which limits a thread to 128 registers.
inline constexpr std::uint32_t kLeastBlocks = 4;

template <class Body>
__global__ void __launch_bounds__(kBlockThreads, kLeastBlocks)
    run_items(std::size_t count, const Body body) {
  for_items_of_thread(std::size_t{blockIdx.x} * blockDim.x + threadIdx.x,
                      std::size_t{gridDim.x} * blockDim.x, count, body);
}

/// Many more than any device runs at once: blocks that finish early make room for the next.
inline constexpr std::uint32_t kMostBlocks = 1u << 20;

template <class Body>
void CudaDevice::for_each(const char* stage, std::size_t count, const Body& body) {
  const LaunchShape shape = launch_shape(count, kMostBlocks);
  if (shape.blocks == 0) return;
  Verb verb(*this, stage);
  verb.begin();
  run_items<<<shape.blocks, shape.threads, 0, verb.stream()>>>(count, body);
  verb.finish(cudaSuccess);
}

}  // namespace raysheaf
