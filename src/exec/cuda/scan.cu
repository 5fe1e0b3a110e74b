#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include <cub/device/device_scan.cuh>

#include "exec/cuda/cuda_device-inl.h"

namespace raysheaf {
namespace {

/// The counts, and a zero behind the last, before which their total then stands.
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

}  // namespace raysheaf
