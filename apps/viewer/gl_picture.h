// Pictures on the screen: textures, and a program that draws them where their cameras saw them.
#pragma once

#include <array>
#include <cstdint>

#include "picture.h"

namespace raysheaf::viewer {

/// Needs the OpenGL context that is current when it is made, and until it is gone.
class GlPicture {
 public:
  /// Throws `Error` (kInternal) where the driver refuses the program.
  GlPicture();
  ~GlPicture();
  GlPicture(const GlPicture&) = delete;
  GlPicture& operator=(const GlPicture&) = delete;

  void upload(const Picture& picture);
  /// Draws side 0, and behind `divider` (of the width) side 1 where there is one. A picture of
  /// another camera than `camera` is drawn on a plane `depth` ahead of its own: it answers a move
  /// at once, until the traced one comes.
  void draw(const Picture& picture, const Camera& camera, float depth, float divider, int width,
            int height) const;

 private:
  unsigned program_ = 0, vertex_array_ = 0;
  std::array<unsigned, 2> textures_{};
  int transform_at_ = 0, corners_at_ = 0;
};

}  // namespace raysheaf::viewer
