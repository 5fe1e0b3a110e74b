#include "gl_program.h"

#include <epoxy/gl.h>

#include <string>
#include <utility>

#include "raysheaf/error.h"

namespace raysheaf::viewer {
namespace {

unsigned compiled(GLenum kind, const char* source) {
  const unsigned shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  int done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == 0) {
    char text[512] = "";
    glGetShaderInfoLog(shader, sizeof text, nullptr, text);
    throw Error(ErrorCode::kInternal, std::string("the driver rejects a shader: ") + text);
  }
  return shader;
}

}  // namespace

GlProgram::GlProgram(const char* vertex_shader, const char* fragment_shader) {
  program_ = glCreateProgram();
  for (const auto& [kind, source] :
       {std::pair(GL_VERTEX_SHADER, vertex_shader), {GL_FRAGMENT_SHADER, fragment_shader}}) {
    const unsigned shader = compiled(static_cast<GLenum>(kind), source);
    glAttachShader(program_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program_);
  int done = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &done);
  if (done == 0) throw Error(ErrorCode::kInternal, "the driver cannot link a program");
}

GlProgram::~GlProgram() {
  glDeleteProgram(program_);
}

void GlProgram::use() const {
  glUseProgram(program_);
}

int GlProgram::at(const char* uniform) const {
  return glGetUniformLocation(program_, uniform);
}

}  // namespace raysheaf::viewer
