// A CUDA device's memory, from a pool that all streams of this process share. For CUDA sources.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <memory>

#include "exec/device_memory.h"

namespace raysheaf {

/// Keeps freed memory for reuse until the pool is destroyed: the device's default pool would unmap
/// it at every synchronization, that is at each stage.
class CudaPool {
 public:
  /// The pool of device `index`, destroyed with its last holder; null if the device does not
  /// support pools. Throws Error with CUDA's message.
  [[nodiscard]] static std::shared_ptr<CudaPool> of(int index);
  explicit CudaPool(int index);
  CudaPool(const CudaPool&) = delete;
  CudaPool& operator=(const CudaPool&) = delete;
  ~CudaPool();

  /// In the order of the stream's work.
  [[nodiscard]] cudaError_t allocate(void** memory, std::size_t bytes, cudaStream_t stream);
  /// Bytes that are reserved but not in use.
  [[nodiscard]] std::uint64_t free_bytes() const;

 private:
  cudaMemPool_t pool_ = nullptr;
};

/// Allocates in the order of a stream's work.
class StreamAllocator : public DeviceAllocator {
 public:
  StreamAllocator(int index, cudaStream_t stream);
  [[nodiscard]] void* allocate(const char* stage, std::size_t bytes) override;
  void free(void* memory) noexcept override;
  /// Free bytes of its pool.
  [[nodiscard]] std::uint64_t free_bytes() const;

 private:
  int index_;
  cudaStream_t stream_;
  std::shared_ptr<CudaPool> pool_;
};

}  // namespace raysheaf
