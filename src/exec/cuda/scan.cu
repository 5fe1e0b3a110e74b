// Scans by CUB and operations based on them share one file, because reading CUB's headers takes
// longer than compiling what is used of them.
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include <cub/device/device_run_length_encode.cuh>
#include <cub/device/device_scan.cuh>
#include <cub/device/device_select.cuh>

#include "exec/cuda/cuda_device_templates.h"

namespace raysheaf {
namespace {

/// The counts, followed by a zero, in whose position the scan writes the total.
struct CountOrZero {
  const std::uint32_t* counts;
  std::size_t size;
  __host__ __device__ std::uint64_t operator()(std::size_t i) const {
    return i < size ? counts[i] : 0;
  }
};

}  // namespace

void CudaDevice::exclusive_scan(const char* stage, View<const std::uint32_t> in,
                                View<std::uint64_t> out) {
  check_item_count(stage, out.size);
  const auto counts = thrust::make_transform_iterator(
      thrust::make_counting_iterator(std::size_t{0}), CountOrZero{in.data, in.size});
  run_cub(stage, [&](void* room, std::size_t& bytes, cudaStream_t stream) {
    return cub::DeviceScan::ExclusiveSum(room, bytes, counts, out.data, static_cast<int>(out.size),
                                         stream);
  });
}

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
