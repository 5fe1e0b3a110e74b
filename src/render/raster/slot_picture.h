// Triangles and pictures where OpenGL has them, for devices that share OpenGL's memory.
#pragma once

#include <any>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/host_device.h"
#include "base/view.h"
#include "render/raster/pack_body.h"

namespace raysheaf {

/// A buffer of OpenGL's.
struct GlMemory {
  unsigned buffer = 0;  ///< OpenGL's name of it
  /// What a device keeps with the buffer. It goes before the buffer does, while the context is
  /// current.
  std::any* lease = nullptr;
};

/// Triangles are drawn under numbers of their own, slots: those that may show, in order.
struct SlotPicture {
  GlMemory memory;         ///< a slot a pixel, rows from the top, or kInvalidId
  std::size_t pixels = 0;  ///< at its beginning; there may be room for more
  /// In the host's memory; none where the device has packed them.
  View<const std::uint32_t> triangle_of_slot;
};

/// Triangles that are packed for one draw call, as `TrianglePacker` does it (render/raster/pack.h).
struct PackedBatch {
  GlMemory corners;  ///< nine floats a triangle, with room for all
  const PictureView& view;
  std::uint32_t first = 0, count = 0;  ///< of the triangles to choose from
  std::uint32_t first_slot = 0;        ///< so many have been drawn
};

/// A device that shares OpenGL's memory. It is called with OpenGL's context current; OpenGL does
/// what it is asked for from then on after what the device was.
class SlotDevice {
 public:
  virtual ~SlotDevice() = default;
  /// Fills the corners; returns how many triangles may show, or nothing where the device does not
  /// write there.
  [[nodiscard]] virtual std::optional<std::uint32_t> pack(const PackedBatch& batch) = 0;
  /// Whether the picture was taken.
  [[nodiscard]] virtual bool take(const SlotPicture& picture) = 0;
};

RAYSHEAF_HD inline std::uint32_t triangle_of_slot(View<const std::uint32_t> triangles,
                                                  std::uint32_t slot) {
  return slot == kInvalidId ? kInvalidId : triangles.data[slot];
}

}  // namespace raysheaf
