// Radix sorts by CUB share one file, because reading CUB's headers takes longer than compiling what
// is used of them.
#include <cub/device/device_radix_sort.cuh>

#include "exec/cuda/cuda_device_templates.h"

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

template <class Key>
void CudaDevice::sort(const char* stage, SortColumns<Key>* columns, BitRange bits) {
  const std::size_t count = columns->keys.size();
  check_item_count(stage, count);
  if (count < 2 || bits.begin >= bits.end) return;
  cub::DoubleBuffer<Key> keys(columns->keys.data(), columns->spare_keys.data());
  cub::DoubleBuffer<std::uint32_t> values(columns->values.data(), columns->spare_values.data());
  run_cub(stage, [&](void* room, std::size_t& bytes, cudaStream_t stream) {
    return cub::DeviceRadixSort::SortPairs(room, bytes, keys, values, static_cast<int>(count),
                                           static_cast<int>(bits.begin), static_cast<int>(bits.end),
                                           stream);
  });
  if (keys.selector != 0) columns->keys.swap(columns->spare_keys);
  if (values.selector != 0) columns->values.swap(columns->spare_values);
}

void CudaDevice::sort_pairs(const char* stage, SortColumns<std::uint32_t>* columns, BitRange bits) {
  sort(stage, columns, bits);
}

void CudaDevice::sort_pairs(const char* stage, SortColumns<std::uint64_t>* columns, BitRange bits) {
  sort(stage, columns, bits);
}

}  // namespace raysheaf
