#include "emulated/emulated_gl.h"

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

void* EmulatedGlBuffer::map(const char* stage, EmulatedDevice& /*device*/,
                            std::size_t bytes) const {
  void* const memory = glMapNamedBufferRange(name_, 0, static_cast<GLsizeiptr>(bytes),
                                             GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
  if (glGetError() != GL_NO_ERROR || memory == nullptr)
    throw Error(ErrorCode::kInternal, "OpenGL does not lend its buffer", stage);
  return memory;
}

void EmulatedGlBuffer::unmap(const char* stage, EmulatedDevice& /*device*/) const {
  if (glUnmapNamedBuffer(name_) != GL_TRUE)
    throw Error(ErrorCode::kInternal, "OpenGL lost its buffer", stage);
}

}  // namespace raysheaf
