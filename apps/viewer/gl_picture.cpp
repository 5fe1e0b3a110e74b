#include "gl_picture.h"

#include <epoxy/gl.h>

#include <utility>

#include "camera_rig.h"
#include "projection.h"

namespace raysheaf::viewer {
namespace {

constexpr const char* kVertexShader = R"(#version 330 core
uniform mat4 transform;
uniform vec3 corners[4];
out vec2 place;
void main() {
  place = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = transform * vec4(corners[gl_VertexID], 1);
}
)";

constexpr const char* kFragmentShader = R"(#version 330 core
uniform sampler2D picture;
in vec2 place;
out vec4 color;
void main() {
  color = texture(picture, place);
}
)";

constexpr std::array<float, 16> kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
/// The whole window, top left first.
constexpr std::array<Vec3, 4> kWindow = {Vec3{-1, 1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};

}  // namespace

GlPicture::GlPicture() : program_(kVertexShader, kFragmentShader) {
  glGenVertexArrays(1, &vertex_array_);
  glGenTextures(kTextures, textures_.data());
  for (const unsigned texture : textures_) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
}

GlPicture::~GlPicture() {
  glDeleteTextures(kTextures, textures_.data());
  glDeleteVertexArrays(1, &vertex_array_);
}

void GlPicture::upload(const Picture& picture) {
  depth_is_uploaded_ = false;
  for (std::size_t side = 0; side < 2; ++side) {
    const Image& image = picture.sides[side].image;
    if (image.rgba.empty()) continue;
    // Texels that are exactly window pixels are not interpolated.
    glBindTexture(GL_TEXTURE_2D, textures_[side]);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<int>(image.width),
                 static_cast<int>(image.height), 0, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  }
}

void GlPicture::upload_depth(const Picture& picture) {
  if (std::exchange(depth_is_uploaded_, true)) return;
  glBindTexture(GL_TEXTURE_2D, textures_[kDepth]);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, static_cast<int>(picture.size.width),
               static_cast<int>(picture.size.height), 0, GL_RED, GL_FLOAT, picture.depth.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
}

void GlPicture::bind(unsigned image_unit, unsigned depth_unit) const {
  glActiveTexture(GL_TEXTURE0 + image_unit);
  glBindTexture(GL_TEXTURE_2D, textures_[0]);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glActiveTexture(GL_TEXTURE0 + depth_unit);
  glBindTexture(GL_TEXTURE_2D, textures_[kDepth]);
  glActiveTexture(GL_TEXTURE0);
}

void GlPicture::draw(const Picture& picture, const Camera& camera, float depth, float divider,
                     int width, int height) const {
  const Camera& own = picture.request.camera;
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const bool same = same_camera(own, camera);
  const std::array<float, 16> transform =
      same ? kIdentity : view_projection(camera, aspect, depth * 1e-3f, depth * 1e3f);
  const float own_aspect =
      static_cast<float>(picture.size.width) / static_cast<float>(picture.size.height);
  const std::array<Vec3, 4> corners = same ? kWindow : picture_corners(own, own_aspect, depth);
  const bool exact = same && static_cast<int>(picture.size.width) == width &&
                     static_cast<int>(picture.size.height) == height;
  program_.use();
  glBindVertexArray(vertex_array_);
  glUniformMatrix4fv(program_.at("transform"), 1, GL_FALSE, transform.data());
  glUniform3fv(program_.at("corners"), 4, &corners[0].x);
  const bool split = !picture.sides[1].image.rgba.empty();
  const int middle = split ? static_cast<int>(divider * static_cast<float>(width)) : width;
  glEnable(GL_SCISSOR_TEST);
  for (int side = 0; side < (split ? 2 : 1); ++side) {
    glScissor(side == 0 ? 0 : middle, 0, side == 0 ? middle : width - middle, height);
    glBindTexture(GL_TEXTURE_2D, textures_[static_cast<std::size_t>(side)]);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, exact ? GL_NEAREST : GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, exact ? GL_NEAREST : GL_LINEAR);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace raysheaf::viewer
