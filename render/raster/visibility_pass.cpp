#include "render/raster/visibility_pass.h"

#include <algorithm>
#include <string>
#include <utility>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

// Three unshared vertices a triangle, so that all three know its number: gl_PrimitiveID makes
// software rasterisers several times slower. Invariant, so that both kinds of targets show the same
// triangles.
constexpr const char* kVertexShader = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 clip;
layout(location = 1) uniform uint first_slot;
flat out uint slot;
invariant gl_Position;
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

constexpr const char* kGbufferVertexShader = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 corner_normal;
layout(location = 2) in vec3 corner_diffuse;
layout(location = 3) in vec3 corner_specular;
layout(location = 0) uniform mat4 clip;
layout(location = 1) uniform uint first_slot;
flat out uint slot;
out vec3 from_eye, normal, diffuse, specular;
invariant gl_Position;
void main() {
  gl_Position = clip * vec4(position, 1.0);
  slot = first_slot + uint(gl_VertexID) / 3u;
  from_eye = position;
  normal = corner_normal;
  diffuse = corner_diffuse;
  specular = corner_specular;
}
)";

constexpr const char* kGbufferFragmentShader = R"(#version 450 core
flat in uint slot;
in vec3 from_eye, normal, diffuse, specular;
layout(location = 2) uniform vec3 eye;
layout(location = 0) out vec4 position_target;
layout(location = 1) out vec4 normal_target;
layout(location = 2) out vec4 diffuse_target;
layout(location = 3) out vec4 specular_target;
void main() {
  float size = length(normal);
  position_target = vec4(eye + from_eye, float(slot & 0xffffffu));
  normal_target = vec4(size > 0.0 ? normal / size : normal, float(slot >> 24u));
  diffuse_target = vec4(diffuse, 1.0);
  specular_target = vec4(specular, 1.0);
}
)";

constexpr GLint kClip = 0, kFirstSlot = 1, kEye = 2;

gl::Program make_program(DrawnTargets targets) {
  return targets == DrawnTargets::kGbuffer
             ? gl::make_program(kGbufferVertexShader, kGbufferFragmentShader)
             : gl::make_program(kVertexShader, kFragmentShader);
}

std::uint32_t largest(GLint limit, GLint viewport) {
  return static_cast<std::uint32_t>(std::max(0, std::min(limit, viewport)));
}

}  // namespace

VisibilityPass::VisibilityPass(DrawnTargets targets)
    : targets_(targets),
      program_(make_program(targets)),
      vertex_array_(gl::make_vertex_array()),
      framebuffer_(gl::make_framebuffer()) {
  GLint limit = 0, viewport[2] = {};
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  max_size_[0] = largest(limit, viewport[0]);
  max_size_[1] = largest(limit, viewport[1]);

  const GLuint array = vertex_array_.name();
  const GLuint attributes = is_gbuffer() ? 4 : 1;  // a Vec3 each
  for (GLuint i = 0; i < attributes; ++i) {
    glEnableVertexArrayAttrib(array, i);
    glVertexArrayAttribFormat(array, i, 3, GL_FLOAT, GL_FALSE,
                              static_cast<GLuint>(i * sizeof(Vec3)));
    glVertexArrayAttribBinding(array, i, 0);
  }
  if (is_gbuffer()) {
    constexpr GLenum kAll[kGbufferTargets] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                              GL_COLOR_ATTACHMENT2, GL_COLOR_ATTACHMENT3};
    glNamedFramebufferDrawBuffers(framebuffer_.name(), kGbufferTargets, kAll);
  }
  // No other code uses the context, so its state is set once.
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
  depth_ = gl::make_renderbuffer();
  const GLuint target = framebuffer_.name();
  for (std::uint32_t i = 0; i < target_count(); ++i) {
    colors_[i] = gl::make_renderbuffer();
    glNamedRenderbufferStorage(colors_[i].name(), is_gbuffer() ? GL_RGBA32F : GL_R32UI, width,
                               height);
    glNamedFramebufferRenderbuffer(target, GL_COLOR_ATTACHMENT0 + i, GL_RENDERBUFFER,
                                   colors_[i].name());
  }
  glNamedRenderbufferStorage(depth_.name(), GL_DEPTH_COMPONENT32F, width, height);
  glNamedFramebufferRenderbuffer(target, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
  gl::check("the targets");
  if (glCheckNamedFramebufferStatus(target, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw Error(ErrorCode::kUnsupported,
                is_gbuffer() ? "the OpenGL driver does not draw to four targets of 32-bit floats"
                             : "the OpenGL driver does not draw to 32-bit integers with 32-bit "
                               "depth");
  }
  std::copy_n(size_, 2, target_size_);
}

void VisibilityPass::clear() const {
  const GLuint target = framebuffer_.name();
  const GLfloat farthest = 0;
  glClearNamedFramebufferfv(target, GL_DEPTH, 0, &farthest);
  if (!is_gbuffer()) {
    const GLuint nothing[4] = {kInvalidId, kInvalidId, kInvalidId, kInvalidId};  // four are read
    glClearNamedFramebufferuiv(target, GL_COLOR, 0, nothing);
    return;
  }
  for (GLint i = 0; i < static_cast<GLint>(kGbufferTargets); ++i) {
    const GLfloat nothing[4] = {0, 0, 0, i == 0 ? -1.0f : 0.0f};
    glClearNamedFramebufferfv(target, GL_COLOR, i, nothing);
  }
}

void VisibilityPass::begin(std::uint32_t width, std::uint32_t height, const ClipMatrix& clip,
                           Vec3 eye) {
  if (width > max_size_[0] || height > max_size_[1]) {
    throw Error(ErrorCode::kUnsupported,
                "an image of " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels is larger than the OpenGL driver's maximum, " +
                    std::to_string(max_size_[0]) + " x " + std::to_string(max_size_[1]));
  }
  size_[0] = width;
  size_[1] = height;
  fit_targets();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glBindVertexArray(vertex_array_.name());
  glUseProgram(program_.name());
  glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  glScissor(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  clear();
  glUniformMatrix4fv(kClip, 1, GL_FALSE, clip.data());
  if (is_gbuffer()) glUniform3f(kEye, eye.x, eye.y, eye.z);
  gl::check("clearing the picture");
}

void VisibilityPass::fit_corners(std::uint32_t count) {
  if (count <= corner_capacity_) return;
  corner_lease_.reset();
  corner_capacity_ = 0;
  corners_ = gl::make_buffer();
  glNamedBufferStorage(corners_.name(), static_cast<GLsizeiptr>(3 * corner_bytes() * count),
                       nullptr, GL_MAP_WRITE_BIT);
  glVertexArrayVertexBuffer(vertex_array_.name(), 0, corners_.name(), 0,
                            static_cast<GLsizei>(corner_bytes()));
  gl::check("the triangles' corners");
  corner_capacity_ = count;
}

void* VisibilityPass::map(std::uint32_t count) {
  fit_corners(count);
  const auto bytes = static_cast<GLsizeiptr>(3 * corner_bytes() * count);
  void* const memory = glMapNamedBufferRange(corners_.name(), 0, bytes,
                                             GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
  gl::check("writing the triangles' corners");
  if (memory == nullptr) {
    throw Error(ErrorCode::kOutOfMemory, "OpenGL provides no memory for the triangles' corners");
  }
  mapped_ = true;
  return memory;
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

void VisibilityPass::read_target(std::uint32_t target, void* to) const {
  const auto width = static_cast<GLsizei>(size_[0]), height = static_cast<GLsizei>(size_[1]);
  glNamedFramebufferReadBuffer(framebuffer_.name(), GL_COLOR_ATTACHMENT0 + target);
  if (is_gbuffer()) {
    glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, to);
  } else {
    glReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, to);
  }
}

void VisibilityPass::read(View<std::uint32_t> slots) const {
  read_target(0, slots.data);
  gl::check("reading the picture");
}

void VisibilityPass::read(std::uint32_t target, View<Vec4> texels) const {
  read_target(target, texels.data);
  gl::check("reading the G-buffer");
}

GlMemory VisibilityPass::pack() {
  const std::size_t pixels = std::size_t{size_[0]} * size_[1];
  const std::size_t bytes = pixels * (is_gbuffer() ? sizeof(Vec4) : sizeof(std::uint32_t));
  if (pixels > packed_capacity_) {
    lease_.reset();
    packed_capacity_ = 0;
    packed_ = gl::make_buffer();
    glNamedBufferData(packed_.name(), static_cast<GLsizeiptr>(bytes * target_count()), nullptr,
                      GL_DYNAMIC_COPY);
    gl::check("a copy of the picture");
    packed_capacity_ = pixels;
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, packed_.name());
  for (std::uint32_t i = 0; i < target_count(); ++i) {
    glPixelStorei(GL_PACK_SKIP_ROWS, static_cast<GLint>(size_[1] * i));  // those of the others
    read_target(i, nullptr);
  }
  glPixelStorei(GL_PACK_SKIP_ROWS, 0);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  gl::check("copying the image");
  return {packed_.name(), &lease_};
}

}  // namespace raysheaf
