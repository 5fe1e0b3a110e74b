#include "render/raster/visibility_pass.h"

#include <algorithm>
#include <string>
#include <utility>

#include "raysheaf/error.h"
#include "render/raster/pack.h"

namespace raysheaf {
namespace {

// Three unshared vertices per triangle, so that all three have its number: gl_PrimitiveID makes
// software rasterizers several times slower.
constexpr const char* kVertexShader = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 clip;
layout(location = 1) uniform uint first_slot;
flat out uint slot;
void main() {
  gl_Position = clip * vec4(position, 1.0);
  slot = first_slot + uint(gl_VertexID) / 3u;
}
)";

constexpr const char* kFragmentShader = R"(#version 450 core
flat in uint slot;
layout(location = 0) out uint pixel;
void main() { pixel = slot; }
)";

constexpr GLint kClip = 0, kFirstSlot = 1;

std::uint32_t largest(GLint limit, GLint viewport) {
  return static_cast<std::uint32_t>(std::max(0, std::min(limit, viewport)));
}

}  // namespace

VisibilityPass::VisibilityPass()
    : program_(gl::make_program(kVertexShader, kFragmentShader)),
      vertex_array_(gl::make_vertex_array()),
      framebuffer_(gl::make_framebuffer()) {
  GLint limit = 0, viewport[2] = {};
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  max_size_[0] = largest(limit, viewport[0]);
  max_size_[1] = largest(limit, viewport[1]);

  const GLuint array = vertex_array_.name();
  glEnableVertexArrayAttrib(array, 0);
  glVertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(array, 0, 0);
  // No other code uses the context, so its state is set once.
  glBindVertexArray(array);
  glUseProgram(program_.name());
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glEnable(GL_SCISSOR_TEST);
  gl::check("the visibility pass");
}

void VisibilityPass::fit_targets() {
  if (size_[0] <= target_size_[0] && size_[1] <= target_size_[1]) return;
  target_size_[0] = target_size_[1] = 0;
  const auto width = static_cast<GLsizei>(size_[0]), height = static_cast<GLsizei>(size_[1]);
  slots_ = gl::make_renderbuffer();
  depth_ = gl::make_renderbuffer();
  glNamedRenderbufferStorage(slots_.name(), GL_R32UI, width, height);
  glNamedRenderbufferStorage(depth_.name(), GL_DEPTH_COMPONENT32F, width, height);
  const GLuint target = framebuffer_.name();
  glNamedFramebufferRenderbuffer(target, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, slots_.name());
  glNamedFramebufferRenderbuffer(target, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
  gl::check("the targets");
  if (glCheckNamedFramebufferStatus(target, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw Error(ErrorCode::kUnsupported,
                "the OpenGL driver does not draw to 32-bit integers with 32-bit depth");
  }
  std::copy_n(size_, 2, target_size_);
}

void VisibilityPass::begin(std::uint32_t width, std::uint32_t height, const ClipMatrix& clip) {
  if (width > max_size_[0] || height > max_size_[1]) {
    throw Error(ErrorCode::kUnsupported,
                "an image of " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels is larger than the OpenGL driver's maximum, " +
                    std::to_string(max_size_[0]) + " x " + std::to_string(max_size_[1]));
  }
  size_[0] = width;
  size_[1] = height;
  fit_targets();
  const GLuint target = framebuffer_.name();
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  glScissor(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  const GLuint nothing[4] = {kInvalidId, kInvalidId, kInvalidId, kInvalidId};  // OpenGL reads four
                                                                               // values
  const GLfloat farthest = 0;
  glClearNamedFramebufferuiv(target, GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(target, GL_DEPTH, 0, &farthest);
  glUniformMatrix4fv(kClip, 1, GL_FALSE, clip.data());
  gl::check("clearing the image");
}

void VisibilityPass::fit_corners(std::uint32_t count) {
  if (count <= corner_capacity_) return;
  constexpr GLsizei kVertexBytes = 3 * sizeof(float);
  corner_lease_.reset();
  corner_capacity_ = 0;
  corners_ = gl::make_buffer();
  glNamedBufferStorage(corners_.name(), GLsizeiptr{3} * kVertexBytes * count, nullptr,
                       GL_MAP_WRITE_BIT);
  glVertexArrayVertexBuffer(vertex_array_.name(), 0, corners_.name(), 0, kVertexBytes);
  gl::check("the triangles' corners");
  corner_capacity_ = count;
}

float* VisibilityPass::map(std::uint32_t count) {
  fit_corners(count);
  const auto bytes = static_cast<GLsizeiptr>(sizeof(float) * kFloatsPerTriangle * count);
  void* const memory = glMapNamedBufferRange(corners_.name(), 0, bytes,
                                             GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
  gl::check("writing the triangles' corners");
  if (memory == nullptr) {
    throw Error(ErrorCode::kOutOfMemory, "OpenGL provides no memory for the triangles' corners");
  }
  mapped_ = true;
  return static_cast<float*>(memory);
}

void VisibilityPass::discard() {
  if (std::exchange(mapped_, false)) glUnmapNamedBuffer(corners_.name());
}

void VisibilityPass::unmap() {
  mapped_ = false;
  if (glUnmapNamedBuffer(corners_.name()) != GL_TRUE) {
    throw Error(ErrorCode::kInternal, "OpenGL lost the triangles' corners");
  }
}

GlMemory VisibilityPass::corners(std::uint32_t count) {
  fit_corners(count);
  return {corners_.name(), &corner_lease_};
}

void VisibilityPass::draw(std::uint32_t count, std::uint32_t first_slot) {
  glUniform1ui(kFirstSlot, first_slot);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * count));
  gl::check("drawing");
}

void VisibilityPass::read(View<std::uint32_t> slots) const {
  glReadPixels(0, 0, static_cast<GLsizei>(size_[0]), static_cast<GLsizei>(size_[1]), GL_RED_INTEGER,
               GL_UNSIGNED_INT, slots.data);
  gl::check("reading the image");
}

GlMemory VisibilityPass::pack() {
  const std::size_t pixels = std::size_t{size_[0]} * size_[1];
  if (pixels > packed_capacity_) {
    lease_.reset();
    packed_capacity_ = 0;
    packed_ = gl::make_buffer();
    glNamedBufferData(packed_.name(), static_cast<GLsizeiptr>(pixels * sizeof(std::uint32_t)),
                      nullptr, GL_DYNAMIC_COPY);
    gl::check("a copy of the image");
    packed_capacity_ = pixels;
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, packed_.name());
  glReadPixels(0, 0, static_cast<GLsizei>(size_[0]), static_cast<GLsizei>(size_[1]), GL_RED_INTEGER,
               GL_UNSIGNED_INT, nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  gl::check("copying the image");
  return {packed_.name(), &lease_};
}

}  // namespace raysheaf
