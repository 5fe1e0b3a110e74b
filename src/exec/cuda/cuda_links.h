// The links of a CUDA device (exec/links.h): page-locked memory, a stream for each uplink, and
// events that order it and the device's own stream.
#pragma once

#include <cstddef>

#include "exec/cuda/cuda_device.h"
#include "exec/links.h"

namespace raysheaf {

/// Page-locked host memory. It grows, and loses its content when it does.
class LockedMemory {
 public:
  LockedMemory() = default;
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;
  ~LockedMemory();

  void resize(const char* stage, std::size_t bytes);
  [[nodiscard]] std::byte* data() const { return static_cast<std::byte*>(data_); }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

class CudaUplink {
 public:
  explicit CudaUplink(CudaDevice& device);
  CudaUplink(const CudaUplink&) = delete;
  CudaUplink& operator=(const CudaUplink&) = delete;
  ~CudaUplink();

  [[nodiscard]] std::byte* room(const char* stage, std::size_t bytes);
  void send(const char* stage, void* to, std::size_t bytes);
  void see(const char* stage);
  void done_with(const char* stage);

 private:
  void close() noexcept;

  CudaDevice& device_;
  UplinkTurns turns_;
  LockedMemory room_;
  void* stream_ = nullptr;                  // a cudaStream_t
  void *sent_ = nullptr, *done_ = nullptr;  // cudaEvent_t
};

class CudaDownlink {
 public:
  explicit CudaDownlink(CudaDevice& device);
  CudaDownlink(const CudaDownlink&) = delete;
  CudaDownlink& operator=(const CudaDownlink&) = delete;
  ~CudaDownlink();

  void ask(const char* stage, const void* from, std::size_t bytes);
  [[nodiscard]] const std::byte* wait(const char* stage);

 private:
  CudaDevice& device_;
  LockedMemory room_;
  void* arrived_ = nullptr;  // a cudaEvent_t
};

}  // namespace raysheaf
