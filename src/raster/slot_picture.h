// A picture where OpenGL has it, for devices that read OpenGL's memory.
#pragma once

#include <any>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "base/host_device.h"
#include "base/view.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// Triangles are drawn under numbers of their own, slots: those that may show, in order.
struct SlotPicture {
  unsigned buffer = 0;  ///< OpenGL's name of it: a slot a pixel, rows from the top, or kInvalidId
  std::size_t pixels = 0;                      ///< at its beginning; there may be room for more
  View<const std::uint32_t> triangle_of_slot;  ///< in the host's memory
  /// What the reader keeps with the buffer. It goes before the buffer does, while the context is
  /// current.
  std::any* lease = nullptr;
};

/// Called with OpenGL's context current. OpenGL writes there again only after what the reader asked
/// for. Whether the picture was taken.
using ReadSlots = std::function<bool(const SlotPicture&)>;

RAYSHEAF_HD inline std::uint32_t triangle_of_slot(View<const std::uint32_t> triangles,
                                                  std::uint32_t slot) {
  return slot == kInvalidId ? kInvalidId : triangles.data[slot];
}

}  // namespace raysheaf
