// An OpenGL buffer that a CUDA device reads or writes in place.
#pragma once

#include <cstddef>

#include "exec/cuda/cuda_device.h"

namespace raysheaf {

/// The context that owns the buffer must be current in every call, including the destructor. This
/// object may outlive the device with which it was made.
class CudaGlBuffer {
 public:
  /// `name`: OpenGL's name of the buffer. Throws Error (kUnsupported) with CUDA's message if the
  /// context does not belong to this device.
  CudaGlBuffer(CudaDevice& device, unsigned name, GlAccess access);
  CudaGlBuffer(const CudaGlBuffer&) = delete;
  CudaGlBuffer& operator=(const CudaGlBuffer&) = delete;
  ~CudaGlBuffer();

  /// Copies the buffer's first bytes to `to`, in the device's memory, in the order of the device's
  /// work: after OpenGL's earlier commands and before its later ones.
  void copy_to(const char* stage, CudaDevice& device, void* to, std::size_t bytes) const;
  /// Maps this many bytes in the device's memory, for its work from now on until `unmap`.
  [[nodiscard]] void* map(const char* stage, CudaDevice& device, std::size_t bytes) const;
  void unmap(const char* stage, CudaDevice& device) const;

 private:
  int index_;
  void* resource_ = nullptr;  // a cudaGraphicsResource_t
};

}  // namespace raysheaf
