// Compiles a case for host and device; only for CUDA sources.
#pragma once

#include "cuda/compiled_cases.h"

namespace raysheaf::test {

template <class Case>
__global__ void run_on_device(std::uint32_t count, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  Draws draws(i);
  Case{}(draws, out[i]);
}

template <class Case>
void run_on_host(std::uint32_t count, Words* out) {
  for (std::uint32_t i = 0; i < count; ++i) {
    Draws draws(i);
    Case{}(draws, out[i]);
  }
}

template <class Case>
CompiledCase compiled(const char* name) {
  return {name, run_on_host<Case>, run_on_device<Case>};
}

}  // namespace raysheaf::test
