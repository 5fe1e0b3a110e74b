// The OpenGL part of the rasterizer: shaders, targets, and the buffer for streaming corners. The
// context must be current in all calls, including destructors.
#pragma once

#include <any>
#include <cstdint>

#include "base/vec.h"
#include "base/view.h"
#include "render/raster/gbuffer_body.h"
#include "render/raster/gl_objects.h"
#include "render/raster/projection.h"
#include "render/raster/slot_picture.h"

namespace raysheaf {

/// The colour attachments of a pass.
enum class DrawnTargets : std::uint8_t {
  kNumbers,  ///< one of 32-bit integers: slots
  kGbuffer,  ///< the paper's four (render/raster/gbuffer_body.h)
};

/// One of several may be used at a time, from `begin` on.
class VisibilityPass {
 public:
  explicit VisibilityPass(DrawnTargets targets = DrawnTargets::kNumbers);

  /// Clears a picture, seen from `eye`. Throws `Error` (kUnsupported) where it is larger than the
  /// targets can be.
  void begin(std::uint32_t width, std::uint32_t height, const ClipMatrix& clip, Vec3 eye);

  /// Memory for the corners of `count` triangles, three Vec3 or `GbufferCorner` each, to be written
  /// and not read, by any thread, until `unmap` or `discard`.
  [[nodiscard]] void* map(std::uint32_t count);
  void unmap();
  void discard();
  /// The same memory for a device to write to, until the next call.
  [[nodiscard]] GlMemory corners(std::uint32_t count);

  /// Draws the first `count` triangles that were written; the first of them has number `first_slot`
  /// in the image.
  void draw(std::uint32_t count, std::uint32_t first_slot);

  /// The image, rows from the top: a slot for each pixel, or kInvalidId.
  void read(View<std::uint32_t> slots) const;
  /// A target of a G-buffer.
  void read(std::uint32_t target, View<Vec4> texels) const;
  /// Copies all targets, one after the other, into a buffer of OpenGL's own, until the next
  /// call.
  [[nodiscard]] GlMemory pack();

 private:
  void fit_targets();
  void fit_corners(std::uint32_t count);

  [[nodiscard]] bool is_gbuffer() const { return targets_ == DrawnTargets::kGbuffer; }
  [[nodiscard]] std::uint32_t target_count() const { return is_gbuffer() ? kGbufferTargets : 1; }
  [[nodiscard]] std::size_t corner_bytes() const {
    return is_gbuffer() ? sizeof(GbufferCorner) : sizeof(Vec3);
  }
  void clear() const;
  void read_target(std::uint32_t target, void* to) const;

  DrawnTargets targets_;
  gl::Program program_;
  gl::VertexArray vertex_array_;
  gl::Buffer corners_;
  gl::Renderbuffer colors_[kGbufferTargets], depth_;
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
