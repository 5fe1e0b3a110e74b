// The OpenGL part of the rasterizer: shaders, targets, and the buffer for streaming corners. The
// context must be current in all calls, including destructors.
#pragma once

#include <any>
#include <cstdint>

#include "base/view.h"
#include "render/raster/gl_objects.h"
#include "render/raster/projection.h"
#include "render/raster/slot_picture.h"

namespace raysheaf {

class VisibilityPass {
 public:
  VisibilityPass();

  /// Clears an image. Throws `Error` (kUnsupported) if it is larger than the targets can be.
  void begin(std::uint32_t width, std::uint32_t height, const ClipMatrix& clip);

  /// Memory for the corners of `count` triangles, for writing only, by any thread, until `unmap` or
  /// `discard`.
  [[nodiscard]] float* map(std::uint32_t count);
  void unmap();
  void discard();
  /// The same memory for a device to write to, until the next call.
  [[nodiscard]] GlMemory corners(std::uint32_t count);

  /// Draws the first `count` triangles that were written; the first of them has number `first_slot`
  /// in the image.
  void draw(std::uint32_t count, std::uint32_t first_slot);

  /// The image, rows from the top: a slot for each pixel, or kInvalidId.
  void read(View<std::uint32_t> slots) const;
  /// The same in an OpenGL buffer, until the next call.
  [[nodiscard]] GlMemory pack();

 private:
  void fit_targets();
  void fit_corners(std::uint32_t count);

  gl::Program program_;
  gl::VertexArray vertex_array_;
  gl::Buffer corners_;
  gl::Renderbuffer slots_, depth_;
  gl::Framebuffer framebuffer_;
  std::uint32_t max_size_[2] = {};
  std::uint32_t size_[2] = {}, target_size_[2] = {};
  std::uint32_t corner_capacity_ = 0;
  bool mapped_ = false;
  gl::Buffer packed_;
  std::size_t packed_capacity_ = 0;
  std::any corner_lease_, lease_;  ///< destroyed before the buffers
};

}  // namespace raysheaf
