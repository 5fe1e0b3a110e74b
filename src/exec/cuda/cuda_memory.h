// A CUDA device's memory: of a pool that all streams of this process share. For CUDA sources.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <memory>

#include "exec/device_memory.h"

namespace raysheaf {

/// Memory that is given back is kept for whoever is next, until the pool goes: the device's own
/// pool would unmap it whenever somebody waits, which is at each stage.
class CudaPool {
 public:
  /// That of device `index`, which goes with the last of its holders; null where the device has no
  /// pools. Throws Error in CUDA's words.
  [[nodiscard]] static std::shared_ptr<CudaPool> of(int index);
  explicit CudaPool(int index);
  CudaPool(const CudaPool&) = delete;
  CudaPool& operator=(const CudaPool&) = delete;
  ~CudaPool();

  /// In the order of the stream.
  [[nodiscard]] cudaError_t allocate(void** memory, std::size_t bytes, cudaStream_t stream);
  /// What it has and nobody uses.
  [[nodiscard]] std::uint64_t free_bytes() const;

 private:
  cudaMemPool_t pool_ = nullptr;
};

/// In the order of a stream.
class StreamAllocator : public DeviceAllocator {
 public:
  StreamAllocator(int index, cudaStream_t stream);
  [[nodiscard]] void* allocate(const char* stage, std::size_t bytes) override;
  void free(void* memory) noexcept override;
  /// Of its pool.
  [[nodiscard]] std::uint64_t free_bytes() const;

 private:
  int index_;
  cudaStream_t stream_;
  std::shared_ptr<CudaPool> pool_;
};

}  // namespace raysheaf
