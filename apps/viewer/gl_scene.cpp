#include "gl_scene.h"

#include <epoxy/gl.h>

#include <bit>
#include <cstddef>

#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr const char* kMeshVertices = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec3 color;
uniform mat4 transform;
uniform mat4 seen_transform;
uniform vec4 seen_ahead;
out vec3 at, direction, tint;
out vec2 texel;
out vec4 seen_at;
void main() {
  at = position;
  direction = normal;
  texel = uv;
  tint = color * color;
  vec4 clip = seen_transform * vec4(position, 1);
  seen_at = vec4(clip.xyw, dot(seen_ahead, vec4(position, 1)));
  gl_Position = transform * vec4(position, 1);
}
)";

/// `seen`: the last traced image, and how far ahead of its camera the points in it are.
constexpr const char* kMeshColors = R"(#version 330 core
uniform sampler2D base, seen, seen_depth;
uniform vec4 eye;
uniform vec3 key, base_color, emission;
uniform float alpha_cutoff, light;
uniform bool unlit, textured, see_through, has_seen;
in vec3 at, direction, tint;
in vec2 texel;
in vec4 seen_at;
out vec4 color;
void main() {
  vec2 dx = dFdx(texel), dy = dFdy(texel);
  vec3 face = cross(dFdx(at), dFdy(at));
  vec4 own = vec4(tint * base_color, 1);
  if (textured && alpha_cutoff > 0) {
    own *= textureGrad(base, texel, dx, dy);
    if (own.a < alpha_cutoff) discard;
  }
  vec2 place = vec2(0.5, 0.5) + vec2(0.5, -0.5) * seen_at.xy / seen_at.z;
  if (has_seen && seen_at.z > 0 && place == clamp(place, vec2(0), vec2(1))) {
    float depth = textureLod(seen_depth, place, 0).r;
    if (abs(depth - seen_at.w) < 0.01 * abs(seen_at.w)) {
      color = vec4(textureLod(seen, place, 0).rgb, 1);
      return;
    }
  }
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (see_through && (pixel.x + pixel.y) % 2 == 0) discard;
  if (textured && alpha_cutoff == 0) own *= textureGrad(base, texel, dx, dy);
  vec3 view = normalize(eye.xyz - eye.w * at);
  vec3 n = dot(direction, direction) > 0 ? normalize(direction) : normalize(face);
  if (dot(n, view) < 0) n = -n;
  float part = 0.4 + 0.6 * max(dot(n, normalize(view + key)), 0) + 0.3 * dot(n, view);
  vec3 linear = own.rgb * (unlit ? 1.0 : light * part) + emission;
  color = vec4(sqrt(min(linear, vec3(1))), 1);
}
)";

/// Two triangles over the whole window.
constexpr const char* kWindowVertices = R"(#version 330 core
out vec2 place;
void main() {
  int corner = gl_VertexID % 3 + gl_VertexID / 3;
  place = vec2(corner & 1, corner >> 1);
  gl_Position = vec4(2 * place - 1, 0, 1);
}
)";

constexpr const char* kWindowColors = R"(#version 330 core
uniform sampler2D canvas;
in vec2 place;
out vec4 color;
void main() {
  color = texture(canvas, place);
}
)";

constexpr const char* kPlainVertices = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 transform;
void main() {
  gl_Position = transform * vec4(position, 1);
}
)";

constexpr const char* kPlainColors = R"(#version 330 core
uniform vec4 ink;
out vec4 color;
void main() {
  color = ink;
}
)";

/// A square of the ground; `cells` counts from the origin of the world.
constexpr const char* kGridVertices = R"(#version 330 core
uniform mat4 transform;
uniform vec3 center, right, ahead;
uniform vec2 center_cells;
uniform float half_cells, cell;
out vec2 cells, from_center;
void main() {
  from_center = vec2(2 * (gl_VertexID & 1) - 1, 2 * (gl_VertexID >> 1) - 1);
  cells = center_cells + from_center * half_cells;
  gl_Position = transform *
      vec4(center + (right * from_center.x + ahead * from_center.y) * half_cells * cell, 1);
}
)";

constexpr const char* kGridColors = R"(#version 330 core
uniform vec3 right_color, ahead_color;
in vec2 cells, from_center;
out vec4 color;
float line(vec2 place, vec2 width) {
  vec2 away = abs(fract(place - 0.5) - 0.5) / width;
  float dense = max(width.x, width.y);
  return (1 - min(min(away.x, away.y), 1)) * (1 - smoothstep(0.2, 0.6, dense));
}
void main() {
  vec2 width = fwidth(cells);
  float fine = 0.35 * line(cells, width), coarse = 0.6 * line(cells / 10, width / 10);
  vec3 ink = vec3(0.55);
  float alpha = max(fine, coarse);
  vec2 axis = 1 - min(abs(cells) / (1.5 * width), 1);
  if (axis.y > 0) { ink = mix(ink, right_color, axis.y); alpha = max(alpha, axis.y); }
  if (axis.x > 0) { ink = mix(ink, ahead_color, axis.x); alpha = max(alpha, axis.x); }
  color = vec4(ink, alpha * (1 - smoothstep(0.5, 1.0, length(from_center))));
}
)";

constexpr float kGridReach = 2;  ///< half of the grid, in diagonals of the scene

int wrap_of(Wrap wrap) {
  switch (wrap) {
    case Wrap::kMirroredRepeat:
      return GL_MIRRORED_REPEAT;
    case Wrap::kClampToEdge:
      return GL_CLAMP_TO_EDGE;
    case Wrap::kRepeat:
      break;
  }
  return GL_REPEAT;
}

void set_vec3(int at, Vec3 v) {
  glUniform3f(at, v.x, v.y, v.z);
}

/// Red, green and blue for x, y and z.
Vec3 color_of_axis(Vec3 axis) {
  const auto part = [](float v) { return 0.25f + 0.6f * std::fabs(v); };
  return {part(axis.x), part(axis.y), part(axis.z)};
}

unsigned new_texture(const PreviewTexture& from) {
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, static_cast<int>(from.image.width),
               static_cast<int>(from.image.height), 0, GL_RGBA, GL_UNSIGNED_BYTE,
               from.image.rgba.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap_of(from.wrap_u));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap_of(from.wrap_v));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glGenerateMipmap(GL_TEXTURE_2D);
  return texture;
}

}  // namespace

GlScene::GlScene()
    : shaded_(kMeshVertices, kMeshColors),
      plain_(kPlainVertices, kPlainColors),
      grid_(kGridVertices, kGridColors),
      window_(kWindowVertices, kWindowColors) {
  glGenVertexArrays(1, &vertex_array_);
  glGenVertexArrays(1, &empty_array_);
  glGenFramebuffers(1, &canvas_);
  PreviewTexture white;
  white.image.width = white.image.height = 1;
  white.image.rgba = {255, 255, 255, 255};
  white_ = new_texture(white);
}

GlScene::~GlScene() {
  delete_mesh();
  glDeleteTextures(1, &white_);
  glDeleteTextures(1, &color_);
  glDeleteRenderbuffers(1, &depth_);
  glDeleteFramebuffers(1, &canvas_);
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteVertexArrays(1, &empty_array_);
}

void GlScene::delete_mesh() {
  glDeleteBuffers(1, &vertex_buffer_);
  glDeleteBuffers(1, &index_buffer_);
  glDeleteTextures(static_cast<int>(mesh_textures_.size()), mesh_textures_.data());
  vertex_buffer_ = index_buffer_ = 0;
  mesh_textures_.clear();
  mesh_.reset();
}

void GlScene::upload(const std::shared_ptr<const PreviewMesh>& mesh) {
  if (mesh == mesh_) return;
  delete_mesh();
  mesh_ = mesh;
  if (mesh == nullptr) return;
  glGenBuffers(1, &vertex_buffer_);
  glGenBuffers(1, &index_buffer_);
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertex_buffer_);
  glBufferData(GL_ARRAY_BUFFER, std::ssize(mesh->vertices) * std::ptrdiff_t{sizeof(PreviewVertex)},
               mesh->vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, std::ssize(mesh->indices) * std::ptrdiff_t{4},
               mesh->indices.data(), GL_STATIC_DRAW);
  const auto attribute = [](unsigned at, int count, GLenum type, bool is_part, std::size_t offset) {
    glEnableVertexAttribArray(at);
    glVertexAttribPointer(at, count, type, is_part ? GL_TRUE : GL_FALSE, sizeof(PreviewVertex),
                          std::bit_cast<const void*>(offset));
  };
  attribute(0, 3, GL_FLOAT, false, offsetof(PreviewVertex, position));
  attribute(1, 3, GL_BYTE, true, offsetof(PreviewVertex, normal));
  attribute(2, 2, GL_FLOAT, false, offsetof(PreviewVertex, uv));
  attribute(3, 3, GL_UNSIGNED_BYTE, true, offsetof(PreviewVertex, color));
  for (const PreviewTexture& texture : mesh->textures)
    mesh_textures_.push_back(new_texture(texture));
}

void GlScene::resize(Size size) {
  if (size == size_) return;
  size_ = size;
  glDeleteTextures(1, &color_);
  glDeleteRenderbuffers(1, &depth_);
  glGenTextures(1, &color_);
  glGenRenderbuffers(1, &depth_);
  const auto width = static_cast<int>(size.width), height = static_cast<int>(size.height);
  glBindTexture(GL_TEXTURE_2D, color_);
  // Software OpenGL enlarges textures in the format of its windows fastest.
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV,
               nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color_, 0);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
}

void GlScene::begin(Size size, const Camera& camera, const Box& bounds, Vec3 background) {
  glBindFramebuffer(GL_FRAMEBUFFER, canvas_);
  resize(size);
  camera_ = camera;
  bounds_ = bounds;
  aspect_ = static_cast<float>(size.width) / static_cast<float>(size.height);
  const DepthRange range = depth_range(camera, bounds);
  transform_ = view_projection(camera, aspect_, range.near, range.far);
  glViewport(0, 0, static_cast<int>(size.width), static_cast<int>(size.height));
  glClearColor(background.x, background.y, background.z, 1);
  glDepthMask(GL_TRUE);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
}

void GlScene::set_camera(const GlProgram& program) const {
  program.use();
  glUniformMatrix4fv(program.at("transform"), 1, GL_FALSE, transform_.data());
}

void GlScene::draw_preview(const Picture* picture, const GlPicture& textures, float light) {
  if (mesh_ == nullptr) return;
  set_camera(shaded_);
  const Vec3 right = normalized(column(camera_.to_world, 0));
  const Vec3 up = normalized(column(camera_.to_world, 1));
  const Vec3 back = normalized(column(camera_.to_world, 2)), eye = column(camera_.to_world, 3);
  const Vec3 from = camera_.orthographic ? back : eye;
  glUniform4f(shaded_.at("eye"), from.x, from.y, from.z, camera_.orthographic ? 0.0f : 1.0f);
  set_vec3(shaded_.at("key"), up * 0.5f - right * 0.4f);
  glUniform1f(shaded_.at("light"), light);
  glUniform1i(shaded_.at("base"), 0);
  glUniform1i(shaded_.at("seen"), 1);
  glUniform1i(shaded_.at("seen_depth"), 2);
  glUniform1i(shaded_.at("has_seen"), picture != nullptr ? 1 : 0);
  if (picture != nullptr) {
    const Camera& own = picture->request.camera;
    const float own_aspect =
        static_cast<float>(picture->size.width) / static_cast<float>(picture->size.height);
    const DepthRange range = depth_range(own, bounds_);
    const auto transform = view_projection(own, own_aspect, range.near, range.far);
    glUniformMatrix4fv(shaded_.at("seen_transform"), 1, GL_FALSE, transform.data());
    const Vec3 ahead = normalized(column(own.to_world, 2)) * -1.0f;
    glUniform4f(shaded_.at("seen_ahead"), ahead.x, ahead.y, ahead.z,
                -dot(ahead, column(own.to_world, 3)));
    textures.bind(1, 2);
  }
  glBindVertexArray(vertex_array_);
  glActiveTexture(GL_TEXTURE0);
  for (const PreviewDraw& draw : mesh_->draws) {
    const bool textured = draw.texture < mesh_textures_.size();
    glBindTexture(GL_TEXTURE_2D, textured ? mesh_textures_[draw.texture] : white_);
    set_vec3(shaded_.at("base_color"), draw.color);
    set_vec3(shaded_.at("emission"), draw.emission);
    glUniform1f(shaded_.at("alpha_cutoff"), draw.alpha_cutoff);
    glUniform1i(shaded_.at("unlit"), draw.unlit ? 1 : 0);
    glUniform1i(shaded_.at("textured"), textured ? 1 : 0);
    glUniform1i(shaded_.at("see_through"), draw.see_through ? 1 : 0);
    draw_part(draw);
  }
  glDisable(GL_CULL_FACE);
}

void GlScene::draw_picture(const Picture& picture, const GlPicture& textures, float depth,
                           float divider) {
  glDisable(GL_DEPTH_TEST);
  textures.draw(picture, camera_, depth, divider, static_cast<int>(size_.width),
                static_cast<int>(size_.height));
  glEnable(GL_DEPTH_TEST);
}

void GlScene::draw_all() const {
  glBindVertexArray(vertex_array_);
  for (const PreviewDraw& draw : mesh_->draws) draw_part(draw);
  glDisable(GL_CULL_FACE);
}

void GlScene::draw_part(const PreviewDraw& draw) const {
  if (draw.double_sided || draw.see_through) {
    glDisable(GL_CULL_FACE);
  } else {
    glEnable(GL_CULL_FACE);
  }
  std::vector<int> counts;
  std::vector<const void*> firsts;
  std::uint32_t end = kInvalidId;  // of the groups so far
  for (const PreviewGroup& group : draw.groups) {
    if (!may_show(transform_, group.box)) continue;
    if (group.first != end) {
      counts.push_back(0);
      firsts.push_back(std::bit_cast<const void*>(std::size_t{4} * group.first));
    }
    counts.back() += static_cast<int>(group.count);
    end = group.first + group.count;
  }
  if (!counts.empty())
    glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, firsts.data(),
                        static_cast<int>(counts.size()));
}

void GlScene::draw_depth() {
  if (mesh_ == nullptr) return;
  set_camera(plain_);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_all();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void GlScene::draw_edges() {
  if (mesh_ == nullptr) return;
  set_camera(plain_);
  glUniform4f(plain_.at("ink"), 0.02f, 0.02f, 0.03f, 0.6f);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glEnable(GL_POLYGON_OFFSET_LINE);
  glPolygonOffset(-1, -4);
  glDepthMask(GL_FALSE);
  draw_all();
  glDepthMask(GL_TRUE);
  glDisable(GL_POLYGON_OFFSET_LINE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glDisable(GL_BLEND);
}

void GlScene::draw_grid(Vec3 up) {
  const GroundGrid grid = ground_grid(bounds_, up);
  set_camera(grid_);
  set_vec3(grid_.at("center"), grid.center);
  set_vec3(grid_.at("right"), grid.right);
  set_vec3(grid_.at("ahead"), grid.ahead);
  glUniform2f(grid_.at("center_cells"), dot(grid.center, grid.right) / grid.cell,
              dot(grid.center, grid.ahead) / grid.cell);
  const float diagonal = length(bounds_.max - bounds_.min);
  glUniform1f(grid_.at("half_cells"), kGridReach * diagonal / grid.cell);
  glUniform1f(grid_.at("cell"), grid.cell);
  set_vec3(grid_.at("right_color"), color_of_axis(grid.right));
  set_vec3(grid_.at("ahead_color"), color_of_axis(grid.ahead));
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(-1, -2);
  glDepthMask(GL_FALSE);
  glBindVertexArray(empty_array_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glDepthMask(GL_TRUE);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_BLEND);
}

void GlScene::finish(Size window) {
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, static_cast<int>(window.width), static_cast<int>(window.height));
  window_.use();
  glBindVertexArray(empty_array_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, color_);
  glUniform1i(window_.at("canvas"), 0);
  glDrawArrays(GL_TRIANGLES, 0, 6);
}

}  // namespace raysheaf::viewer
