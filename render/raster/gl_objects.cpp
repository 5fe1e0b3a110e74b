#include "render/raster/gl_objects.h"

#include <array>
#include <cstdio>
#include <string>

#include "raysheaf/error.h"

namespace raysheaf::gl {
namespace {

using Log = std::array<char, 512>;

Shader compile(GLenum type, const char* source) {
  Shader shader(glCreateShader(type));
  glShaderSource(shader.name(), 1, &source, nullptr);
  glCompileShader(shader.name());
  GLint good = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return shader;
  Log log{};
  glGetShaderInfoLog(shader.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Error(ErrorCode::kInternal, std::string("the shader does not compile: ") + log.data());
}

}  // namespace

void check(const char* what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR;) ++i;
  if (error == GL_OUT_OF_MEMORY) {
    throw Error(ErrorCode::kOutOfMemory, std::string("OpenGL is out of memory for ") + what);
  }
  std::array<char, 32> code;
  std::snprintf(code.data(), code.size(), "0x%04x", error);
  throw Error(ErrorCode::kInternal,
              std::string("OpenGL reports error ") + code.data() + " for " + what);
}

Program make_program(const char* vertex_source, const char* fragment_source) {
  const Shader vertex = compile(GL_VERTEX_SHADER, vertex_source);
  const Shader fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
  Program program(glCreateProgram());
  glAttachShader(program.name(), vertex.name());
  glAttachShader(program.name(), fragment.name());
  glLinkProgram(program.name());
  GLint good = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &good);
  if (good == GL_TRUE) return program;
  Log log{};
  glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Error(ErrorCode::kInternal, std::string("the shaders do not link: ") + log.data());
}

}  // namespace raysheaf::gl
