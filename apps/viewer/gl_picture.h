// Images on the screen: textures, and a program that draws them where their cameras saw them.
#pragma once

#include <array>
#include <cstdint>

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
  /// Draws side 0, and right of `divider` (a part of the width) side 1, if it exists. An image of a
  /// camera other than `camera` is drawn on a plane `depth` ahead of its own camera: it shows a
  /// move at once, until the traced image arrives.
  void draw(const Picture& picture, const Camera& camera, float depth, float divider, int width,
            int height) const;

 private:
  unsigned program_ = 0, vertex_array_ = 0;
  std::array<unsigned, 2> textures_{};
  int transform_at_ = 0, corners_at_ = 0;
};

}  // namespace raysheaf::viewer
