// Lets OpenGL draw triangles from a device's memory, and brings the image back. For sources that
// include a device.
#pragma once

#include <any>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "exec/device.h"
#include "render/device/frame_stages.h"
#include "render/raster/pack_body.h"
#include "render/raster/slot_picture.h"

namespace raysheaf {

/// Flags the triangles from `first` on that may be visible in an image.
template <class Device>
void choose_shown_on(Device& device, const TriangleList& list, const PictureView& view,
                     std::uint32_t first, View<std::uint8_t> shown) {
  device.for_each("raster: choose", shown.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Vec3* const corner = list.corners.data + 3 * (first + i);
    const Vec3 eye = view.frame.eye;
    const std::uint8_t flags = list.flags.empty() ? 0 : list.flags.data[first + i];
    shown.data[i] =
        may_show(view, corner[0] - eye, corner[1] - eye, corner[2] - eye, flags) ? 1 : 0;
  });
}

/// Packs the corners of the flagged ones, relative to the eye; `names` receives their numbers.
template <class Device>
void pack_shown_on(Device& device, const TriangleList& list, Vec3 eye, std::uint32_t first,
                   View<const std::uint32_t> chosen, std::uint32_t* names, Vec3* corners) {
  device.for_each("raster: pack", chosen.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t triangle = first + chosen.data[i];
    for (std::size_t k = 0; k < 3; ++k)
      corners[3 * i + k] = list.corners.data[std::size_t{3} * triangle + k] - eye;
    names[i] = triangle;
  });
}

/// Converts slots to triangle numbers, in place.
template <class Device>
void name_triangles_on(Device& device, View<const std::uint32_t> names,
                       View<std::uint32_t> pixels) {
  device.for_each("copy: names", pixels.size, [=] RAYSHEAF_DEVICE(std::size_t pixel) {
    pixels.data[pixel] = triangle_of_slot(names, pixels.data[pixel]);
  });
}

/// Shares OpenGL's memory if the device can; otherwise triangles and image are copied through the
/// host. Setting the variable RAYSHEAF_NO_INTEROP to anything but 0 forces the copies.
template <class Device>
class GlLink final : public SlotDevice {
 public:
  explicit GlLink(Device& device) : device_(device) {
    const char* const off = std::getenv("RAYSHEAF_NO_INTEROP");
    if (off != nullptr && *off != '\0' && std::string_view(off) != "0")
      refusal_ = "RAYSHEAF_NO_INTEROP is set";
  }

  /// The triangle that each of `pixels` pixels sees, before silhouettes are resolved; valid until
  /// the next call. `triangles`: those to draw, in the device's memory.
  [[nodiscard]] View<const std::uint32_t> see(const Rasterize& rasterize, const CameraFrame& frame,
                                              std::size_t pixels, const TriangleList& triangles) {
    list_ = triangles;
    pixels_.resize_uninitialized(kStage, pixels);
    const std::vector<std::uint32_t> seen = rasterize(frame, refusal_.empty() ? this : nullptr);
    copied_ = !seen.empty();
    if (copied_) device_.copy(kStage, pixels_.data(), seen.data(), pixels * sizeof seen[0]);
    return pixels_.view_const();
  }

  /// A phrase that describes how the last image was transferred.
  [[nodiscard]] std::string way() const {
    if (copied_)
      return "OpenGL's image is copied there, because " +
             (refusal_.empty() ? "processes share it" : refusal_);
    return "OpenGL draws its triangles, and their image is read in place";
  }

  [[nodiscard]] std::optional<std::uint32_t> pack(const PackedBatch& batch) override {
    const Buffer* const buffer = leased(batch.corners, GlAccess::kWrite);
    if (buffer == nullptr) return std::nullopt;
    shown_.resize_uninitialized(kPack, batch.count);
    chosen_.resize_uninitialized(kPack, batch.count);
    if (batch.first_slot == 0) names_.resize_uninitialized(kPack, list_.count());
    choose_shown_on(device_, list_, batch.view, batch.first, shown_.view());
    const std::uint32_t count =
        device_.select("raster: select", shown_.view_const(), chosen_.view());
    if (count == 0) return 0;
    Mapped mapped(*buffer, device_, std::size_t{count} * 3 * sizeof(Vec3));
    pack_shown_on(device_, list_, batch.view.frame.eye, batch.first,
                  chosen_.view_const().slice(0, count), names_.data() + batch.first_slot,
                  mapped.corners());
    mapped.unmap();
    return count;
  }

  [[nodiscard]] bool take(const SlotPicture& picture) override {
    const Buffer* const buffer = leased(picture.memory, GlAccess::kRead);
    if (buffer == nullptr) return false;
    if (!picture.triangle_of_slot.empty()) {
      names_.resize_uninitialized(kStage, picture.triangle_of_slot.size);
      device_.copy(kStage, names_.data(), picture.triangle_of_slot.data,
                   names_.size() * sizeof(std::uint32_t));
    }
    buffer->copy_to(kStage, device_, pixels_.data(), pixels_.size() * sizeof(std::uint32_t));
    name_triangles_on(device_, names_.view_const(), pixels_.view());
    return true;
  }

 private:
  using Buffer = typename Device::GlBuffer;
  static constexpr const char *kStage = "copy: names", *kPack = "raster: pack";

  class Mapped {
   public:
    Mapped(const Buffer& buffer, Device& device, std::size_t bytes)
        : buffer_(buffer), device_(device), memory_(buffer.map(kPack, device, bytes)) {}
    /// Runs after an error, whose message is the one to report.
    ~Mapped() {
      try {
        unmap();
      } catch (const Error&) {
      }
    }
    Mapped(const Mapped&) = delete;
    Mapped& operator=(const Mapped&) = delete;
    [[nodiscard]] Vec3* corners() const { return static_cast<Vec3*>(memory_); }
    void unmap() {
      if (std::exchange(memory_, nullptr) != nullptr) buffer_.unmap(kPack, device_);
    }

   private:
    const Buffer& buffer_;
    Device& device_;
    void* memory_;
  };

  /// Null if the device does not share OpenGL's memory; `refusal_` says why.
  [[nodiscard]] const Buffer* leased(const GlMemory& memory, GlAccess access) {
    using Lease = std::shared_ptr<const Buffer>;
    if (const Lease* const old = std::any_cast<Lease>(memory.lease)) return old->get();
    try {
      memory.lease->reset();
      return memory.lease
          ->template emplace<Lease>(std::make_shared<Buffer>(device_, memory.buffer, access))
          .get();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kUnsupported) throw;
      refusal_ = error.sentence();
      return nullptr;
    }
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  TriangleList list_;
  DeviceBuffer<std::uint8_t> shown_{memory_};
  DeviceBuffer<std::uint32_t> chosen_{memory_};
  DeviceBuffer<std::uint32_t> pixels_{memory_}, names_{memory_};
  bool copied_ = false;  ///< the last image went through the host
  std::string refusal_;  ///< why memory is not shared; empty: it is
};

}  // namespace raysheaf
