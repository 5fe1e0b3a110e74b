// Radix sort of pairs by CUB; included by one source a type of key, for they take long to compile.
#pragma once

#include <cub/device/device_radix_sort.cuh>

#include "exec/cuda/cuda_device-inl.h"

namespace raysheaf {

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

}  // namespace raysheaf
