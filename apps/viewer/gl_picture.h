// Images on the screen: textures, and a program that draws them where their cameras saw them.
#pragma once

#include <array>
#include <cstddef>

#include "gl_program.h"
#include "picture.h"

namespace raysheaf::viewer {

/// Needs the current OpenGL context for its whole lifetime.
class GlPicture {
 public:
  /// Throws `Error` (kInternal) if the driver rejects the program.
  GlPicture();
  ~GlPicture();
  GlPicture(const GlPicture&) = delete;
  GlPicture& operator=(const GlPicture&) = delete;

  void upload(const Picture& picture);
  /// Does nothing if it has been done since `upload`.
  void upload_depth(const Picture& picture);
  /// Binds the textures of side 0 and of its depth to these units.
  void bind(unsigned image_unit, unsigned depth_unit) const;
  /// Draws side 0, and right of `divider` (a part of the width) side 1, if it exists. An image of a
  /// camera other than `camera` is drawn on a plane `depth` ahead of its own camera: it shows a
  /// move at once, until the traced image arrives.
  void draw(const Picture& picture, const Camera& camera, float depth, float divider, int width,
            int height) const;

 private:
  static constexpr int kTextures = 3;
  static constexpr std::size_t kDepth = 2;

  GlProgram program_;
  unsigned vertex_array_ = 0;
  std::array<unsigned, kTextures> textures_{};  ///< both sides, and the depth
  bool depth_is_uploaded_ = false;
};

}  // namespace raysheaf::viewer
