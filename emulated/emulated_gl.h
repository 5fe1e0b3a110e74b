// An OpenGL buffer that an emulated device reads or writes (render/backends/cuda_gl.h).
#pragma once

#include <cstddef>

#include "emulated/emulated_device.h"

namespace raysheaf {

class EmulatedGlBuffer {
 public:
  EmulatedGlBuffer(EmulatedDevice& /*device*/, unsigned name, GlAccess /*access*/) : name_(name) {}

  /// `to`: an address in the device's memory.
  void copy_to(const char* stage, EmulatedDevice& device, void* to, std::size_t bytes) const;
  [[nodiscard]] void* map(const char* stage, EmulatedDevice& device, std::size_t bytes) const;
  void unmap(const char* stage, EmulatedDevice& device) const;

 private:
  unsigned name_;
};

}  // namespace raysheaf
