// Triangles and images in OpenGL's memory, for devices that share it.
#pragma once

#include <any>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/host_device.h"
#include "base/view.h"
#include "render/raster/pack_body.h"

namespace raysheaf {

/// An OpenGL buffer.
struct GlMemory {
  unsigned buffer = 0;  ///< OpenGL's name of it
  /// Data that a device stores with the buffer. They are destroyed before the buffer, while the
  /// context is current.
  std::any* lease = nullptr;
};

/// Triangles are drawn with numbers of their own, slots: the visible candidates in order.
struct SlotPicture {
  /// A slot a pixel, rows from the top, or kInvalidId; of a G-buffer its four targets, one after
  /// the other, four floats a pixel (render/raster/gbuffer_body.h).
  GlMemory memory;
  std::size_t pixels = 0;  ///< at its beginning; there may be room for more
  /// In the host's memory; none where the device has packed them.
  View<const std::uint32_t> triangle_of_slot;
  bool gbuffer = false;
};

/// Triangles that are packed for one draw call, as by `TrianglePacker` (render/raster/pack.h).
struct PackedBatch {
  GlMemory corners;  ///< three Vec3 a triangle, or `GbufferCorner`, with room for all
  const PictureView& view;
  std::uint32_t first = 0, count = 0;  ///< of the triangles to choose from
  std::uint32_t first_slot = 0;        ///< so many have been drawn
  bool gbuffer = false;
};

/// A device that shares OpenGL's memory. It is called with OpenGL's context current; OpenGL's later
/// commands run after the device's work.
class SlotDevice {
 public:
  virtual ~SlotDevice() = default;
  /// Fills the corners; returns how many triangles may be visible, or nothing if the device cannot
  /// write there.
  [[nodiscard]] virtual std::optional<std::uint32_t> pack(const PackedBatch& batch) = 0;
  /// Whether the image was taken.
  [[nodiscard]] virtual bool take(const SlotPicture& picture) = 0;
};

RAYSHEAF_HD inline std::uint32_t triangle_of_slot(View<const std::uint32_t> triangles,
                                                  std::uint32_t slot) {
  return slot == kInvalidId ? kInvalidId : triangles.data[slot];
}

}  // namespace raysheaf
