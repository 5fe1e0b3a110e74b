#include "exec/cuda/cuda_device.h"

#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_memory.h"

namespace raysheaf {
namespace {

constexpr const char* kOpening = "CUDA device";

std::string described(int index) {
  cudaDeviceProp properties;
  check_cuda(cudaGetDeviceProperties(&properties, index), kOpening);
  return std::string(properties.name) + ", compute capability " + std::to_string(properties.major) +
         "." + std::to_string(properties.minor);
}

cudaPointerAttributes said_of(const void* pointer) {
  cudaPointerAttributes said{};
  if (cudaPointerGetAttributes(&said, pointer) == cudaSuccess) return said;
  static_cast<void>(cudaGetLastError());
  said.type = cudaMemoryTypeUnregistered;
  return said;
}

bool lies_on_a_device(const void* pointer) {
  const cudaMemoryType type = said_of(pointer).type;
  return type == cudaMemoryTypeDevice || type == cudaMemoryTypeManaged;
}

/// Records an event after this stream's work so far; creates it first if necessary.
void record(const char* stage, void** event, void* stream) {
  if (*event == nullptr) {
    cudaEvent_t made = nullptr;
    check_cuda(cudaEventCreate(&made), stage);
    *event = made;
  }
  check_cuda(cudaEventRecord(event_of(*event), static_cast<cudaStream_t>(stream)), stage);
}

struct Nothing {
  __host__ __device__ void operator()(std::size_t /*i*/) const {}
};

}  // namespace

CudaDevice::OwnStream::OwnStream(int of_device) : index(of_device) {
  int count = 0;
  check_cuda(cudaGetDeviceCount(&count), kOpening);
  const CurrentDevice current(index, kOpening);
  cudaStream_t stream = nullptr;
  check_cuda(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), kOpening);
  handle = stream;
}

CudaDevice::OwnStream::~OwnStream() {
  const CurrentDevice current(index);
  ignore_cuda(cudaStreamDestroy(static_cast<cudaStream_t>(handle)));
}

CudaDevice::CudaDevice(int index, DeviceAllocator* allocator)
    : index_(index),
      stream_(index),
      own_allocator_(allocator != nullptr
                         ? nullptr
                         : new StreamAllocator(index, static_cast<cudaStream_t>(stream()))),
      allocator_(allocator != nullptr ? allocator : own_allocator_.get()),
      scratch_(*allocator_),
      counter_(*allocator_) {
  name_ = described(index);
  // Launches an empty kernel: only this shows whether the build contains code for the device.
  for_each(kOpening, 1, Nothing{});
  synchronize(kOpening);
}

CudaDevice::~CudaDevice() {
  const CurrentDevice current(index_);
  for (const Mark& mark : marks_) {
    if (mark.begin != nullptr) ignore_cuda(cudaEventDestroy(mark.begin));
    if (mark.end != nullptr) ignore_cuda(cudaEventDestroy(mark.end));
  }
  if (clock_start_ != nullptr) ignore_cuda(cudaEventDestroy(event_of(clock_start_)));
  if (clock_stop_ != nullptr) ignore_cuda(cudaEventDestroy(event_of(clock_stop_)));
  scratch_.release();
  counter_.release();
  ignore_cuda(cudaStreamSynchronize(static_cast<cudaStream_t>(stream())));
}

void CudaDevice::fill_bytes(const char* stage, void* place, std::size_t bytes, std::uint8_t byte) {
  if (bytes == 0) return;
  Verb verb(*this, stage);
  verb.begin();
  verb.finish(cudaMemsetAsync(place, byte, bytes, verb.stream()));
}

void CudaDevice::copy(const char* stage, void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  Verb verb(*this, stage);
  verb.begin();
  verb.finish(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDefault, verb.stream()));
  if (!lies_on_a_device(to) || !lies_on_a_device(from)) synchronize(stage);
}

void CudaDevice::synchronize(const char* stage) {
  const CurrentDevice current(index_, stage);
  check_cuda(cudaStreamSynchronize(static_cast<cudaStream_t>(stream())), stage);
}

void CudaDevice::start_clock(const char* stage) {
  const CurrentDevice current(index_, stage);
  synchronize(stage);
  record(stage, &clock_start_, stream());
}

double CudaDevice::stop_clock(const char* stage) {
  const CurrentDevice current(index_, stage);
  record(stage, &clock_stop_, stream());
  check_cuda(cudaEventSynchronize(event_of(clock_stop_)), stage);
  float ms = 0;
  check_cuda(cudaEventElapsedTime(&ms, event_of(clock_start_), event_of(clock_stop_)), stage);
  return ms;
}

bool may_follow(const cudaPointerAttributes& said, int index, const char* name) {
  if (said.type == cudaMemoryTypeDevice && said.device != index)
    throw Error(ErrorCode::kInvalidArgument,
                "lies in the memory of CUDA device " + std::to_string(said.device) +
                    ", and the context is on CUDA device " + std::to_string(index),
                name);
  return said.type == cudaMemoryTypeDevice || said.type == cudaMemoryTypeManaged;
}

bool CudaDevice::is_device_memory(const void* pointer, const char* name) const {
  return may_follow(said_of(pointer), index_, name);
}

void CudaDevice::wait_for(const char* stage, void* stream) {
  const CurrentDevice current(index_, stage);
  const auto other = static_cast<cudaStream_t>(stream);
  cudaStreamCaptureStatus capture = cudaStreamCaptureStatusNone;
  check_cuda(cudaStreamIsCapturing(other, &capture), stage);
  if (capture != cudaStreamCaptureStatusNone)
    throw Error(ErrorCode::kInvalidArgument,
                "is being captured into a graph, but a query cannot be part of a graph", "stream");
  cudaEvent_t event = nullptr;
  check_cuda(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), stage);
  cudaError_t status = cudaEventRecord(event, other);
  if (status == cudaSuccess)
    status = cudaStreamWaitEvent(static_cast<cudaStream_t>(stream_.handle), event, 0);
  ignore_cuda(cudaEventDestroy(event));
  check_cuda(status, stage);
}

std::uint64_t CudaDevice::free_bytes() const {
  const CurrentDevice current(index_, "CUDA device: memory");
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "CUDA device: memory");
  return free + (own_allocator_ != nullptr ? own_allocator_->free_bytes() : 0);
}

bool CudaDevice::reads_host_memory() const {
  int reads = 0;
  check_cuda(cudaDeviceGetAttribute(&reads, cudaDevAttrPageableMemoryAccess, index_),
             "CUDA device: memory");
  return reads != 0;
}

void* CudaDevice::scratch(const char* stage, std::size_t bytes) {
  scratch_.resize_uninitialized(stage, bytes == 0 ? 1 : bytes);
  return scratch_.data();
}

std::uint32_t* CudaDevice::counter(const char* stage) {
  counter_.resize_uninitialized(stage, 1);
  return counter_.data();
}

std::uint32_t CudaDevice::counted(const char* stage) {
  return read(stage, counter_.data());
}

void CudaDevice::keep_times(bool keep) {
  keeps_times_ = false;
  static_cast<void>(times());
  keeps_times_ = keep;
}

std::vector<StageTime> CudaDevice::times() {
  const CurrentDevice current(index_, "stage times");
  synchronize("stage times");
  std::vector<StageTime> times;
  for (const Mark& mark : marks_) {
    float ms = 0;
    if (mark.begin != nullptr && mark.end != nullptr &&
        cudaEventElapsedTime(&ms, mark.begin, mark.end) == cudaSuccess)
      add_stage_time(mark.stage, ms, &times);
    if (mark.begin != nullptr) ignore_cuda(cudaEventDestroy(mark.begin));
    if (mark.end != nullptr) ignore_cuda(cudaEventDestroy(mark.end));
  }
  static_cast<void>(cudaGetLastError());
  marks_.clear();
  return times;
}

}  // namespace raysheaf
