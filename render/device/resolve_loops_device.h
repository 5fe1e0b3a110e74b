// Makes OpenGL's image agree with rays, as loops. For sources that include a device.
#pragma once

#include "base/view.h"
#include "exec/device.h"
#include "object_tree/triangle_list.h"
#include "render/raster/resolve_body.h"

namespace raysheaf {

/// A flat scene's triangles in a device's memory.
struct TrianglesThere {
  TriangleList list;

  [[nodiscard]] RAYSHEAF_HD Vec3 corner(std::uint32_t triangle, int k) const {
    return list.corners.data[std::uint64_t{3} * triangle + static_cast<std::uint64_t>(k)];
  }
  [[nodiscard]] RAYSHEAF_HD std::uint8_t flags_of(std::uint32_t triangle) const {
    return list.flags.data[triangle];
  }
};

/// `lost`: 1 for each pixel whose ray does not hit the pixel's triangle, else 0.
template <class Device>
void look_at_borders_on(Device& device, Resolve<TrianglesThere> resolve, std::uint8_t* lost) {
  device.for_each("resolve: borders", resolve.before.size, [=] RAYSHEAF_DEVICE(std::size_t pixel) {
    lost[pixel] = look_at_border(resolve, pixel) ? 1 : 0;
  });
}

template <class Device>
void look_for_triangles_on(Device& device, Resolve<TrianglesThere> resolve,
                           View<const std::uint32_t> lost) {
  device.for_each("resolve: triangles", resolve.triangles.list.flags.size,
                  [=] RAYSHEAF_DEVICE(std::size_t triangle) {
                    look_for(resolve, lost, static_cast<std::uint32_t>(triangle));
                  });
}

template <class Device>
void resolve_pixels_on(Device& device, Resolve<TrianglesThere> resolve, std::uint32_t* triangles) {
  device.for_each("resolve: pixels", resolve.before.size, [=] RAYSHEAF_DEVICE(std::size_t pixel) {
    triangles[pixel] = resolved_pixel(resolve.before.data[pixel], resolve.sight[pixel]);
  });
}

/// `changed`: 1 for each pixel that shows another triangle in `next` than in `shown`, else 0.
template <class Device>
void look_around_on(Device& device, Resolve<TrianglesThere> resolve,
                    View<const std::uint32_t> shown, std::uint32_t* next, std::uint8_t* changed) {
  device.for_each("resolve: pixels", shown.size, [=] RAYSHEAF_DEVICE(std::size_t pixel) {
    next[pixel] = look_around(resolve, shown, pixel);
    changed[pixel] = next[pixel] != shown.data[pixel] ? 1 : 0;
  });
}

/// `resolve_silhouettes` (render/raster/resolve.h), on a device.
template <class Device>
class ResolverOn {
 public:
  explicit ResolverOn(Device& device) : device_(device) {}

  /// `seen`: OpenGL's result. All arrays are in the device's memory.
  void resolve(const TriangleList& list, const Box& bounds, const CameraFrame& frame,
               View<const std::uint32_t> seen, View<std::uint32_t> triangles) {
    if (!(frame.z_far > frame.z_near))
      return device_.copy("copy: names", triangles.data, seen.data, seen.size * sizeof seen[0]);
    sight_.resize_uninitialized("resolve: borders", triangles.size);
    device_.fill("resolve: borders", sight_.view(), 0xff);
    flags_.resize_uninitialized("resolve: borders", triangles.size);
    lost_.resize_uninitialized("resolve: borders", triangles.size);
    const Resolve<TrianglesThere> resolve{
        make_picture_view(frame, bounds), {list}, seen, sight_.data()};
    look_at_borders_on(device_, resolve, flags_.data());
    const std::uint32_t lost =
        device_.select("resolve: borders", flags_.view_const(), lost_.view());
    look_for_triangles_on(device_, resolve, {lost_.data(), lost});
    resolve_pixels_on(device_, resolve, triangles.data);
    next_.resize_uninitialized("resolve: pixels", triangles.size);
    const auto changed = [&] {
      look_around_on(device_, resolve, {triangles.data, triangles.size}, next_.data(),
                     flags_.data());
      return device_.select("resolve: pixels", flags_.view_const(), lost_.view()) != 0;
    };
    while (changed())
      device_.copy("copy: names", triangles.data, next_.data(), next_.size() * sizeof seen[0]);
  }

 private:
  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceBuffer<std::uint32_t> lost_{memory_}, next_{memory_};
  DeviceBuffer<SightKey> sight_{memory_};
  DeviceBuffer<std::uint8_t> flags_{memory_};
};

}  // namespace raysheaf
