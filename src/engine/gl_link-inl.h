// What OpenGL saw, brought to a device; for the sources that know which device it is.
#pragma once

#include <any>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/frame_stages.h"
#include "exec/device.h"
#include "raster/slot_picture.h"

namespace raysheaf {

/// Slots become triangles, in place.
template <class Device>
void name_triangles_on(Device& device, View<const std::uint32_t> names,
                       View<std::uint32_t> pixels) {
  device.for_each("copy: names", pixels.size, [=] RAYSHEAF_DEVICE(std::size_t pixel) {
    pixels.data[pixel] = triangle_of_slot(names, pixels.data[pixel]);
  });
}

/// Reads the picture where it lies, if the device can; else it is copied through the host. The
/// variable RAYSHEAF_NO_INTEROP, set to anything but 0, has it copied at once.
template <class Device>
class GlReader {
 public:
  explicit GlReader(Device& device) : device_(device) {
    const char* const off = std::getenv("RAYSHEAF_NO_INTEROP");
    if (off != nullptr && *off != '\0' && std::string_view(off) != "0")
      refusal_ = "RAYSHEAF_NO_INTEROP is set";
  }

  /// The triangle that each of so many pixels sees, silhouettes not resolved yet; until the next
  /// call.
  [[nodiscard]] View<const std::uint32_t> see(const Rasterize& rasterize, const CameraFrame& frame,
                                              std::size_t pixels) {
    pixels_.resize_uninitialized(kStage, pixels);
    ReadSlots read;
    if (refusal_.empty()) read = [this](const SlotPicture& picture) { return take(picture); };
    const std::vector<std::uint32_t> seen = rasterize(frame, read);
    copied_ = !seen.empty();
    if (copied_) device_.copy(kStage, pixels_.data(), seen.data(), pixels * sizeof seen[0]);
    return pixels_.view_const();
  }

  /// How the last picture came, in words.
  [[nodiscard]] std::string way() const {
    if (!copied_) return "read where it lies";
    return "copied there, for " + (refusal_.empty() ? "processes share it" : refusal_);
  }

 private:
  using Buffer = typename Device::GlBuffer;
  static constexpr const char* kStage = "copy: names";

  bool take(const SlotPicture& picture) {
    const Buffer* const buffer = leased(picture);
    if (buffer == nullptr) return false;
    names_.resize_uninitialized(kStage, picture.triangle_of_slot.size);
    device_.copy(kStage, names_.data(), picture.triangle_of_slot.data,
                 names_.size() * sizeof(std::uint32_t));
    buffer->copy_to(kStage, device_, pixels_.data(), pixels_.size() * sizeof(std::uint32_t));
    name_triangles_on(device_, names_.view_const(), pixels_.view());
    return true;
  }

  /// Null where the device does not read what OpenGL has; `refusal_` says why.
  [[nodiscard]] const Buffer* leased(const SlotPicture& picture) {
    using Lease = std::shared_ptr<const Buffer>;
    if (const Lease* const old = std::any_cast<Lease>(picture.lease)) return old->get();
    try {
      picture.lease->reset();
      return picture.lease->emplace<Lease>(std::make_shared<Buffer>(device_, picture.buffer)).get();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kUnsupported) throw;
      refusal_ = error.sentence();
      return nullptr;
    }
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceBuffer<std::uint32_t> pixels_{memory_}, names_{memory_};
  bool copied_ = false;  ///< the last picture, through the host
  std::string refusal_;  ///< why nothing is read where it lies; empty: all is
};

}  // namespace raysheaf
