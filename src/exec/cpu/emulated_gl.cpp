#include "exec/cpu/emulated_gl.h"

#include <epoxy/gl.h>

#include "raysheaf/error.h"

namespace raysheaf {

void EmulatedGlBuffer::copy_to(const char* stage, EmulatedDevice& /*device*/, void* to,
                               std::size_t bytes) const {
  glGetNamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(bytes), to);
  if (glGetError() != GL_NO_ERROR)
    throw Error(ErrorCode::kInternal, "OpenGL does not give its buffer", stage);
}

}  // namespace raysheaf
