#include "exec/cuda/cuda_links.h"

#include <chrono>

#include "exec/cuda/cuda_device_templates.h"

namespace raysheaf {
namespace {

constexpr const char* kLinking = "CUDA device: links";

cudaStream_t stream_of(void* stream) {
  return static_cast<cudaStream_t>(stream);
}

/// Longer than the copy of one part of a large array (exec/bulk_links.h), which takes tens of
/// microseconds, and longer than waking a thread.
constexpr std::chrono::microseconds kLongestSpin{200};

/// Spins at first, long enough for a part of a large array; then sleeps, so that threads that read
/// and decode can use the processor.
void wait_for_event(const char* stage, void* event) {
  const auto end = std::chrono::steady_clock::now() + kLongestSpin;
  cudaError_t status;
  do status = cudaEventQuery(event_of(event));
  while (status == cudaErrorNotReady && std::chrono::steady_clock::now() < end);
  ignore_cuda(status);  // clears "not ready", which is not an error
  if (status == cudaErrorNotReady) status = cudaEventSynchronize(event_of(event));
  check_cuda(status, stage);
}

/// A thread that waits for this event by `cudaEventSynchronize` sleeps.
cudaEvent_t new_event() {
  cudaEvent_t event = nullptr;
  check_cuda(cudaEventCreateWithFlags(&event, cudaEventDisableTiming | cudaEventBlockingSync),
             kLinking);
  return event;
}

void destroy_event(void* event) {
  if (event != nullptr) ignore_cuda(cudaEventDestroy(event_of(event)));
}

}  // namespace

LockedMemory::~LockedMemory() {
  if (data_ != nullptr) ignore_cuda(cudaFreeHost(data_));
}

void LockedMemory::resize(const char* stage, std::size_t bytes) {
  if (bytes <= size_) return;
  if (data_ != nullptr) ignore_cuda(cudaFreeHost(data_));
  data_ = nullptr;
  size_ = 0;
  check_cuda(cudaMallocHost(&data_, bytes), stage);
  size_ = bytes;
}

CudaUplink::CudaUplink(CudaDevice& device) : device_(device) {
  const CurrentDevice current(device_.index(), kLinking);
  try {
    cudaStream_t stream = nullptr;
    check_cuda(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), kLinking);
    stream_ = stream;
    sent_ = new_event();
    done_ = new_event();
  } catch (...) {
    close();
    throw;
  }
}

CudaUplink::~CudaUplink() {
  close();
}

void CudaUplink::close() noexcept {
  const CurrentDevice current(device_.index());
  if (stream_ != nullptr) {
    ignore_cuda(cudaStreamSynchronize(stream_of(stream_)));
    ignore_cuda(cudaStreamDestroy(stream_of(stream_)));
  }
  destroy_event(sent_);
  destroy_event(done_);
}

std::byte* CudaUplink::room(const char* stage, std::size_t bytes) {
  const CurrentDevice current(device_.index(), stage);
  wait_for_event(stage, sent_);  // returns at once if nothing was sent yet
  room_.resize(stage, bytes);
  return room_.data();
}

void CudaUplink::send(const char* stage, void* to, std::size_t bytes) {
  turns_.send(stage);
  const CurrentDevice current(device_.index(), stage);
  check_cuda(cudaStreamWaitEvent(stream_of(stream_), event_of(done_), 0), stage);
  if (bytes != 0) {
    check_cuda(cudaMemcpyAsync(to, room_.data(), bytes, cudaMemcpyHostToDevice, stream_of(stream_)),
               stage);
  }
  check_cuda(cudaEventRecord(event_of(sent_), stream_of(stream_)), stage);
}

void CudaUplink::see(const char* stage) {
  turns_.see(stage);
  const CurrentDevice current(device_.index(), stage);
  check_cuda(cudaStreamWaitEvent(stream_of(device_.stream()), event_of(sent_), 0), stage);
}

void CudaUplink::done_with(const char* stage) {
  turns_.done_with(stage);
  const CurrentDevice current(device_.index(), stage);
  check_cuda(cudaEventRecord(event_of(done_), stream_of(device_.stream())), stage);
}

CudaDownlink::CudaDownlink(CudaDevice& device) : device_(device) {
  const CurrentDevice current(device_.index(), kLinking);
  arrived_ = new_event();
}

CudaDownlink::~CudaDownlink() {
  const CurrentDevice current(device_.index());
  ignore_cuda(cudaEventSynchronize(event_of(arrived_)));  // so that no copy still writes to the
                                                          // memory
  destroy_event(arrived_);
}

void CudaDownlink::ask(const char* stage, const void* from, std::size_t bytes) {
  const CurrentDevice current(device_.index(), stage);
  wait_for_event(stage, arrived_);
  room_.resize(stage, bytes);
  if (bytes != 0) {
    check_cuda(cudaMemcpyAsync(room_.data(), from, bytes, cudaMemcpyDeviceToHost,
                               stream_of(device_.stream())),
               stage);
  }
  check_cuda(cudaEventRecord(event_of(arrived_), stream_of(device_.stream())), stage);
}

const std::byte* CudaDownlink::wait(const char* stage) {
  const CurrentDevice current(device_.index(), stage);
  wait_for_event(stage, arrived_);
  return room_.data();
}

}  // namespace raysheaf
