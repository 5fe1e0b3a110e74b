#include <thrust/iterator/counting_iterator.h>

#include <cub/device/device_select.cuh>

#include "exec/cuda/cuda_device-inl.h"

namespace raysheaf {

std::uint32_t CudaDevice::select(const char* stage, View<const std::uint8_t> flags,
                                 View<std::uint32_t> out) {
  check_item_count(stage, flags.size);
  if (flags.empty()) return 0;
  std::uint32_t* const count = counter(stage);
  run_cub(stage, [&](void* room, std::size_t& bytes, cudaStream_t stream) {
    return cub::DeviceSelect::Flagged(room, bytes, thrust::make_counting_iterator(0u), flags.data,
                                      out.data, count, static_cast<int>(flags.size), stream);
  });
  return counted(stage);
}

}  // namespace raysheaf
