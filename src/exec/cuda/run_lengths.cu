#include <cub/device/device_run_length_encode.cuh>

#include "exec/cuda/cuda_device-inl.h"

namespace raysheaf {

std::uint32_t CudaDevice::run_lengths(const char* stage, View<const std::uint32_t> keys,
                                      RunColumns out) {
  check_item_count(stage, keys.size);
  if (keys.empty()) return 0;
  std::uint32_t* const count = counter(stage);
  run_cub(stage, [&](void* room, std::size_t& bytes, cudaStream_t stream) {
    return cub::DeviceRunLengthEncode::Encode(room, bytes, keys.data, out.keys.data,
                                              out.lengths.data, count, static_cast<int>(keys.size),
                                              stream);
  });
  return counted(stage);
}

}  // namespace raysheaf
