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
#include "render/device/staged_scene.h"
#include "render/raster/gbuffer_body.h"
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

/// The same with what a G-buffer shows.
template <class Device>
void pack_gbuffer_on(Device& device, const StagedSceneView& scene, const CameraFrame& frame,
                     std::uint32_t first, View<const std::uint32_t> chosen, std::uint32_t* names,
                     GbufferCorner* corners) {
  device.for_each("raster: pack", chosen.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t triangle = first + chosen.data[i];
    const Vec3* const at = scene.corners.data + std::size_t{3} * triangle;
    const Vec3 corner[3] = {at[0], at[1], at[2]};
    const Vec3 sight = sight_of_triangle(frame, corner[0]);
    const auto surface_in = [&](int k) {
      return staged_surface(scene, triangle, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f, sight);
    };
    make_gbuffer_corners(corner, frame.eye, surface_in, corners + 3 * i);
    names[i] = triangle;
  });
}

/// The slots that a G-buffer's targets name; `texels`: position, normal, diffuse, specular.
template <class Device>
void slots_of_gbuffer_on(Device& device, const Vec4* texels, View<std::uint32_t> pixels) {
  device.for_each("copy: names", pixels.size, [=] RAYSHEAF_DEVICE(std::size_t pixel) {
    pixels.data[pixel] = slot_of_texels(texels[pixel].w, texels[pixels.size + pixel].w);
  });
}

/// Slots become triangles, in place.
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

  /// The triangle that each of so many pixels sees, silhouettes not resolved yet; until the next
  /// call. `triangles`: those that are drawn, and `scene`, in the device's memory. `draws_gbuffer`:
  /// the paper's targets are drawn.
  [[nodiscard]] View<const std::uint32_t> see(const Rasterize& rasterize, const CameraFrame& frame,
                                              std::size_t pixels, const TriangleList& triangles,
                                              const StagedSceneView& scene, bool draws_gbuffer) {
    Gbuffer of_other_samples;
    Gbuffer* const gbuffer = frame.sample.index == 0 ? &gbuffer_ : &of_other_samples;
    if (frame.sample.index == 0) gbuffer_ = {};
    list_ = triangles;
    scene_ = scene;
    pixels_.resize_uninitialized(kStage, pixels);
    const std::vector<std::uint32_t> seen =
        rasterize(frame, refusal_.empty() ? this : nullptr, draws_gbuffer ? gbuffer : nullptr);
    copied_ = !seen.empty();
    if (draws_gbuffer && !copied_) download(gbuffer);
    if (copied_) device_.copy(kStage, pixels_.data(), seen.data(), pixels * sizeof seen[0]);
    return pixels_.view_const();
  }

  /// The targets of the first sample, from the last frame that drew them.
  [[nodiscard]] const Gbuffer& gbuffer() const { return gbuffer_; }

  /// Whether memory is shared, as far as is known.
  [[nodiscard]] bool shares() const { return refusal_.empty(); }
  /// How the last picture came, in words.
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
    const View<const std::uint32_t> chosen = chosen_.view_const().slice(0, count);
    std::uint32_t* const names = names_.data() + batch.first_slot;
    const CameraFrame& frame = batch.view.frame;
    const std::size_t corner_bytes = batch.gbuffer ? sizeof(GbufferCorner) : sizeof(Vec3);
    Mapped mapped(*buffer, device_, std::size_t{count} * 3 * corner_bytes);
    if (batch.gbuffer) {
      pack_gbuffer_on(device_, scene_, frame, batch.first, chosen, names,
                      static_cast<GbufferCorner*>(mapped.memory()));
    } else {
      pack_shown_on(device_, list_, frame.eye, batch.first, chosen, names,
                    static_cast<Vec3*>(mapped.memory()));
    }
    mapped.unmap();
    return count;
  }

  [[nodiscard]] bool take(const SlotPicture& picture) override {
    const Buffer* const buffer = leased(picture.memory, GlAccess::kRead);
    if (buffer == nullptr) return false;
    if (!picture.triangle_of_slot.empty())
      upload(device_, kStage, picture.triangle_of_slot, &names_);
    if (picture.gbuffer) {
      texels_.resize_uninitialized(kStage, kGbufferTargets * picture.pixels);
      buffer->copy_to(kStage, device_, texels_.data(), texels_.size() * sizeof(Vec4));
      slots_of_gbuffer_on(device_, texels_.data(), pixels_.view());
    } else {
      buffer->copy_to(kStage, device_, pixels_.data(), pixels_.size() * sizeof(std::uint32_t));
    }
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
    [[nodiscard]] void* memory() const { return memory_; }
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

  /// Copies OpenGL's targets from the device's memory.
  void download(Gbuffer* gbuffer) {
    const std::size_t pixels = pixels_.size();
    const Vec4* from = texels_.data();
    for (std::vector<Vec4>* target :
         {&gbuffer->position, &gbuffer->normal, &gbuffer->diffuse, &gbuffer->specular}) {
      target->resize(pixels);
      device_.copy(kStage, target->data(), from, pixels * sizeof(Vec4));
      from += pixels;
    }
    device_.synchronize(kStage);
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  TriangleList list_;
  StagedSceneView scene_;
  DeviceBuffer<std::uint8_t> shown_{memory_};
  DeviceBuffer<std::uint32_t> chosen_{memory_};
  DeviceBuffer<std::uint32_t> pixels_{memory_}, names_{memory_};
  DeviceBuffer<Vec4> texels_{memory_};  ///< of a G-buffer
  Gbuffer gbuffer_;
  bool copied_ = false;  ///< the last picture, through the host
  std::string refusal_;  ///< why nothing is shared; empty: all is
};

}  // namespace raysheaf
