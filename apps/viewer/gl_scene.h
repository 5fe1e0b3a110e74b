// The scene as OpenGL draws it: a preview while the camera moves, edges of triangles, a grid.
//
//   begin ─► draw_preview, or draw_picture and draw_depth ─► draw_edges, draw_grid ─► finish
//
// The preview takes its colours from the last traced image, where that image sees the same point,
// and shades the other points simply.
#pragma once

#include <memory>
#include <vector>

#include "gl_picture.h"
#include "gl_program.h"
#include "preview_mesh.h"
#include "projection.h"

namespace raysheaf::viewer {

/// Needs the current OpenGL context for its whole lifetime.
class GlScene {
 public:
  /// Throws `Error` (kInternal) if the driver rejects a program.
  GlScene();
  ~GlScene();
  GlScene(const GlScene&) = delete;
  GlScene& operator=(const GlScene&) = delete;

  /// Does nothing if the mesh has been uploaded. Null: no mesh.
  void upload(const std::shared_ptr<const PreviewMesh>& mesh);

  /// Clears an image of `size`, which the next calls draw on as `camera` sees it. `bounds` are
  /// those of the scene.
  void begin(Size size, const Camera& camera, const Box& bounds, Vec3 background);
  /// `picture`: the traced image that is reprojected; null: none. `light`: a factor on the light of
  /// the other points.
  void draw_preview(const Picture* picture, const GlPicture& textures, float light);
  /// Draws a traced image as `GlPicture::draw` does.
  void draw_picture(const Picture& picture, const GlPicture& textures, float depth, float divider);
  /// Hides lines behind the mesh.
  void draw_depth();
  void draw_edges();
  /// On the ground of the scene; `up` is a unit vector along an axis.
  void draw_grid(Vec3 up);
  /// Copies the image to the window.
  void finish(Size window);

 private:
  void resize(Size size);
  void delete_mesh();
  void set_camera(const GlProgram& program) const;
  void draw_all() const;
  /// Without back faces, where the tracer does not show them, and without what is not in view.
  void draw_part(const PreviewDraw& draw) const;

  GlProgram shaded_, plain_, grid_, window_;
  std::shared_ptr<const PreviewMesh> mesh_;
  std::vector<unsigned> mesh_textures_;
  unsigned vertex_array_ = 0, empty_array_ = 0, vertex_buffer_ = 0, index_buffer_ = 0;
  unsigned canvas_ = 0, color_ = 0, depth_ = 0, white_ = 0;
  Size size_;
  Camera camera_;
  Box bounds_;
  float aspect_ = 1;
  std::array<float, 16> transform_{};
};

}  // namespace raysheaf::viewer
