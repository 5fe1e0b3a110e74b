#include <cub/device/device_radix_sort.cuh>

#include "exec/cuda/cuda_device-inl.h"

namespace raysheaf {

void CudaDevice::sort_keys(const char* stage, SortColumns<std::uint64_t>* columns, BitRange bits) {
  const std::size_t count = columns->keys.size();
  check_item_count(stage, count);
  if (count < 2 || bits.begin >= bits.end) return;
  cub::DoubleBuffer<std::uint64_t> keys(columns->keys.data(), columns->spare_keys.data());
  run_cub(stage, [&](void* room, std::size_t& bytes, cudaStream_t stream) {
    return cub::DeviceRadixSort::SortKeys(room, bytes, keys, static_cast<int>(count),
                                          static_cast<int>(bits.begin), static_cast<int>(bits.end),
                                          stream);
  });
  if (keys.selector != 0) columns->keys.swap(columns->spare_keys);
}

}  // namespace raysheaf
