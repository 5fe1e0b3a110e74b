#include "exec/cpu/emulated_gl.h"

#include <epoxy/gl.h>

#include <vector>

#include "raysheaf/error.h"

namespace raysheaf {

void EmulatedGlBuffer::copy_to(const char* stage, EmulatedDevice& device, void* to,
                               std::size_t bytes) const {
  std::vector<std::byte> read(bytes);
  glGetNamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(bytes), read.data());
  if (glGetError() != GL_NO_ERROR)
    throw Error(ErrorCode::kInternal, "OpenGL does not give its buffer", stage);
  device.copy(stage, to, read.data(), bytes);
}

}  // namespace raysheaf
