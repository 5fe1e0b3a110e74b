#include "exec/cuda/cuda_memory.h"

#include <limits>
#include <map>
#include <mutex>

#include "exec/cuda/cuda_device_templates.h"

namespace raysheaf {
namespace {

constexpr const char* kPooling = "CUDA device: memory";

}  // namespace

std::shared_ptr<CudaPool> CudaPool::of(int index) {
  static std::mutex mutex;
  static std::map<int, std::weak_ptr<CudaPool>> pools;
  int supported = 0;
  check_cuda(cudaDeviceGetAttribute(&supported, cudaDevAttrMemoryPoolsSupported, index), kPooling);
  if (supported == 0) return nullptr;
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<CudaPool> pool = pools[index].lock();
  if (pool == nullptr) {
    pool = std::make_shared<CudaPool>(index);
    pools[index] = pool;
  }
  return pool;
}

CudaPool::CudaPool(int index) {
  cudaMemPoolProps properties{};
  properties.allocType = cudaMemAllocationTypePinned;
  properties.location.type = cudaMemLocationTypeDevice;
  properties.location.id = index;
  check_cuda(cudaMemPoolCreate(&pool_, &properties), kPooling);
  std::uint64_t kept = std::numeric_limits<std::uint64_t>::max();
  const cudaError_t status = cudaMemPoolSetAttribute(pool_, cudaMemPoolAttrReleaseThreshold, &kept);
  if (status != cudaSuccess) ignore_cuda(cudaMemPoolDestroy(pool_));
  check_cuda(status, kPooling);
}

CudaPool::~CudaPool() {
  ignore_cuda(cudaMemPoolDestroy(pool_));
}

cudaError_t CudaPool::allocate(void** memory, std::size_t bytes, cudaStream_t stream) {
  cudaError_t status = cudaMallocFromPoolAsync(memory, bytes, pool_, stream);
  if (status != cudaErrorMemoryAllocation) return status;
  // The pool's free memory may be fragmented: retry after returning it to the device.
  ignore_cuda(status);
  ignore_cuda(cudaStreamSynchronize(stream));
  ignore_cuda(cudaMemPoolTrimTo(pool_, 0));
  return cudaMallocFromPoolAsync(memory, bytes, pool_, stream);
}

std::uint64_t CudaPool::free_bytes() const {
  std::uint64_t reserved = 0, used = 0;
  check_cuda(cudaMemPoolGetAttribute(pool_, cudaMemPoolAttrReservedMemCurrent, &reserved),
             kPooling);
  check_cuda(cudaMemPoolGetAttribute(pool_, cudaMemPoolAttrUsedMemCurrent, &used), kPooling);
  return reserved > used ? reserved - used : 0;
}

StreamAllocator::StreamAllocator(int index, cudaStream_t stream)
    : index_(index), stream_(stream), pool_(CudaPool::of(index)) {}

void* StreamAllocator::allocate(const char* stage, std::size_t bytes) {
  const CurrentDevice current(index_, stage);
  void* memory = nullptr;
  check_cuda(
      pool_ != nullptr ? pool_->allocate(&memory, bytes, stream_) : cudaMalloc(&memory, bytes),
      stage);
  return memory;
}

void StreamAllocator::free(void* memory) noexcept {
  // Errors are ignored: a device that has failed cannot free memory, and the caller could not
  // handle that.
  const CurrentDevice current(index_);
  ignore_cuda(pool_ != nullptr ? cudaFreeAsync(memory, stream_) : cudaFree(memory));
}

std::uint64_t StreamAllocator::free_bytes() const {
  return pool_ != nullptr ? pool_->free_bytes() : 0;
}

}  // namespace raysheaf
