// Owners of OpenGL objects. The context that made an object must be current when it is assigned to
// or destroyed.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace raysheaf::gl {

template <void (*Delete)(GLuint)>
class Object {
 public:
  Object() = default;
  explicit Object(GLuint name) : name_(name) {}
  Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    if (this != &other) {
      if (name_ != 0) Delete(name_);
      name_ = std::exchange(other.name_, 0);
    }
    return *this;
  }
  ~Object() {
    if (name_ != 0) Delete(name_);
  }
  [[nodiscard]] GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

inline void delete_buffer(GLuint name) {
  glDeleteBuffers(1, &name);
}
inline void delete_vertex_array(GLuint name) {
  glDeleteVertexArrays(1, &name);
}
inline void delete_renderbuffer(GLuint name) {
  glDeleteRenderbuffers(1, &name);
}
inline void delete_framebuffer(GLuint name) {
  glDeleteFramebuffers(1, &name);
}
inline void delete_shader(GLuint name) {
  glDeleteShader(name);
}
inline void delete_program(GLuint name) {
  glDeleteProgram(name);
}

using Buffer = Object<delete_buffer>;
using VertexArray = Object<delete_vertex_array>;
using Renderbuffer = Object<delete_renderbuffer>;
using Framebuffer = Object<delete_framebuffer>;
using Shader = Object<delete_shader>;
using Program = Object<delete_program>;

inline Buffer make_buffer() {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  return Buffer(name);
}
inline VertexArray make_vertex_array() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return VertexArray(name);
}
inline Renderbuffer make_renderbuffer() {
  GLuint name = 0;
  glCreateRenderbuffers(1, &name);
  return Renderbuffer(name);
}
inline Framebuffer make_framebuffer() {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return Framebuffer(name);
}

/// Throws `Error` if OpenGL has recorded an error since the last call: kOutOfMemory, or kInternal.
void check(const char* what);

/// A linked program. Throws `Error` (kInternal) with the compiler's message.
[[nodiscard]] Program make_program(const char* vertex_source, const char* fragment_source);

}  // namespace raysheaf::gl
