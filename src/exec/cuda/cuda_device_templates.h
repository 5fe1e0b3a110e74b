// Internals of CudaDevice, for the CUDA sources in this folder.
#pragma once

#include <cuda_runtime.h>

#include "exec/cuda/cuda_device.h"
#include "exec/cuda/cuda_error.h"

namespace raysheaf {

/// Makes device `index` current for this thread, and restores the previous device at the end of the
/// scope.
class CurrentDevice {
 public:
  explicit CurrentDevice(int index) noexcept {
    status_ = cudaGetDevice(&before_);
    if (status_ == cudaSuccess) status_ = cudaSetDevice(index);
    changed_ = status_ == cudaSuccess && before_ != index;
    ignore_cuda(status_);
  }
  CurrentDevice(int index, const char* stage) : CurrentDevice(index) { check_cuda(status_, stage); }
  CurrentDevice(const CurrentDevice&) = delete;
  CurrentDevice& operator=(const CurrentDevice&) = delete;
  ~CurrentDevice() {
    if (changed_) ignore_cuda(cudaSetDevice(before_));
  }

 private:
  cudaError_t status_;
  int before_ = 0;
  bool changed_ = false;
};

[[nodiscard]] inline cudaEvent_t event_of(void* event) {
  return static_cast<cudaEvent_t>(event);
}

/// Whether kernels of device `index` may access a pointer with these attributes. Throws as
/// `is_device_memory` does.
[[nodiscard]] bool may_follow(const cudaPointerAttributes& said, int index, const char* name);

struct CudaDevice::Mark {
  const char* stage;
  cudaEvent_t begin, end;
};

class CudaDevice::Verb {
 public:
  Verb(CudaDevice& device, const char* stage)
      : device_(device), stage_(stage), current_(device.index_, stage) {
    static_cast<void>(cudaGetLastError());  // clears errors of earlier calls, which do not belong
                                            // to this verb
  }
  [[nodiscard]] cudaStream_t stream() const { return static_cast<cudaStream_t>(device_.stream()); }
  /// Marks the beginning of the verb's work; call it right before queuing the work. The stage's
  /// time includes any host work after this that the stream waits for.
  void begin() {
    if (!device_.keeps_times_) return;
    Mark mark{stage_, nullptr, nullptr};
    check_cuda(cudaEventCreate(&mark.begin), stage_);
    device_.marks_.push_back(mark);
    check_cuda(cudaEventCreate(&device_.marks_.back().end), stage_);
    check_cuda(cudaEventRecord(mark.begin, stream()), stage_);
  }
  /// Checks that the work was queued, and marks its end.
  void finish(cudaError_t status) {
    check_cuda(status, stage_);
    check_cuda(cudaGetLastError(), stage_);
    if (device_.keeps_times_)
      check_cuda(cudaEventRecord(device_.marks_.back().end, stream()), stage_);
  }

 private:
  CudaDevice& device_;
  const char* stage_;
  const CurrentDevice current_;
};

template <class Call>
void CudaDevice::run_cub(const char* stage, const Call& call) {
  Verb verb(*this, stage);
  std::size_t bytes = 0;
  check_cuda(call(nullptr, bytes, verb.stream()), stage);
  void* const room = scratch(stage, bytes);
  verb.begin();
  verb.finish(call(room, bytes, verb.stream()));
}

}  // namespace raysheaf
