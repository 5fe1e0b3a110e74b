// A buffer of OpenGL's, read by an emulated device (exec/cuda/cuda_gl.h).
#pragma once

#include <cstddef>

#include "exec/cpu/emulated_device.h"

namespace raysheaf {

class EmulatedGlBuffer {
 public:
  EmulatedGlBuffer(EmulatedDevice& /*device*/, unsigned name) : name_(name) {}

  /// `to`: of the device's memory.
  void copy_to(const char* stage, EmulatedDevice& device, void* to, std::size_t bytes) const;

 private:
  unsigned name_;
};

}  // namespace raysheaf
