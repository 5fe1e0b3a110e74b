// A buffer of OpenGL's, read or written by a CUDA device where it lies.
#pragma once

#include <cstddef>

#include "exec/cuda/cuda_device.h"

namespace raysheaf {

/// The context that owns the buffer is current wherever anything is called, the destructor
/// included. It may outlive the device that it was made with.
class CudaGlBuffer {
 public:
  /// `name`: OpenGL's. Throws Error (kUnsupported), in CUDA's words, where the context is not this
  /// device's.
  CudaGlBuffer(CudaDevice& device, unsigned name, GlAccess access);
  CudaGlBuffer(const CudaGlBuffer&) = delete;
  CudaGlBuffer& operator=(const CudaGlBuffer&) = delete;
  ~CudaGlBuffer();

  /// Its first bytes go to `to`, in the device's memory, in the order of the device's work: after
  /// what OpenGL was asked for before, and before what it is asked for from now on.
  void copy_to(const char* stage, CudaDevice& device, void* to, std::size_t bytes) const;
  /// So many bytes in the device's memory, for its work from now on and until `unmap`.
  [[nodiscard]] void* map(const char* stage, CudaDevice& device, std::size_t bytes) const;
  void unmap(const char* stage, CudaDevice& device) const;

 private:
  int index_;
  void* resource_ = nullptr;  // a cudaGraphicsResource_t
};

}  // namespace raysheaf
