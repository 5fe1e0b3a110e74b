// Resolving a rasterised image as devices do it.
#pragma once

#include "cuda/stage_cases.h"
#include "render/raster/resolve_body.h"

namespace raysheaf::test {

struct ResolveCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    std::uint32_t ids[9];
    for (std::uint32_t& id : ids) id = draws.below(3) == 0 ? kInvalidId : draws.below(2);
    const std::uint32_t x = draws.below(3), y = draws.below(3);
    Neighbourhood near = neighbourhood(View<const std::uint32_t>(ids, 9), 3, 3, x, y);
    near.add(1);
    const std::uint8_t flags = draws.below(2) == 0 ? 0 : kSingleSided;
    out.put(near.count, shows_side(flags, draws.below(2) == 0));
    const SightKey sight = sight_key(draws.between(0, 9), y);
    out.put(sight, triangle_of(sight), distance_of(sight), is_uniform(ids + 4, 3));
  }
};

/// Two triangles in front of the camera, and an image of 3 x 3 pixels.
struct SmallPicture {
  static constexpr std::uint32_t kSide = 3, kPixels = kSide * kSide;
  struct Two {
    Vec3 corners[2][3];
    std::uint8_t flags[2];
    [[nodiscard]] RAYSHEAF_HD Vec3 corner(std::uint32_t triangle, int k) const {
      return corners[triangle][k];
    }
    [[nodiscard]] RAYSHEAF_HD std::uint8_t flags_of(std::uint32_t triangle) const {
      return flags[triangle];
    }
  };
  Two two;
  std::uint32_t before[kPixels];
  SightKey sight[kPixels];
  CameraFrame frame;
  ClipMatrix clip{};

  RAYSHEAF_HD explicit SmallPicture(Draws& draws) {
    frame.right = {1, 0, 0};
    frame.up = {0, 1, 0};
    frame.forward = {0, 0, -1};
    frame.width = frame.height = kSide;
    frame.orthographic = draws.below(4) == 0;
    for (int t = 0; t < 2; ++t) {
      for (Vec3& corner : two.corners[t]) corner = draws.in_box(2) - Vec3{0, 0, 3};
      two.flags[t] = draws.below(2) == 0 ? 0 : kSingleSided;
    }
    for (std::uint32_t i = 0; i < kPixels; ++i) {
      const std::uint32_t id = draws.below(3);
      before[i] = id == 2 ? kInvalidId : id;
      sight[i] = kNotLooked;
    }
    // A matrix that keeps x and y and sets w to the depth.
    clip[0] = 1;
    clip[5] = -1;
    clip[14] = 0.01f;
    clip[11] = frame.orthographic ? 0.0f : -1.0f;
    clip[15] = frame.orthographic ? 1.0f : 0.0f;
  }
  [[nodiscard]] RAYSHEAF_HD Resolve<Two> resolve() {
    return {{frame, clip}, two, {before, kPixels}, sight};
  }
};

struct SilhouetteCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    SmallPicture picture(draws);
    const Resolve<SmallPicture::Two> resolve = picture.resolve();
    const Vec3* const corner = picture.two.corners[0];
    out.put(may_show(resolve.view, corner[0], corner[1], corner[2], picture.two.flags[0]));
    out.put(outside(picture.clip, corner[0]),
            facing(picture.frame, corner[0], corner[1], corner[2]));
    float box[5] = {2, 2, -2, -2, 9};
    out.put(grow(picture.clip, corner[1], box), box[0], box[1], box[2], box[3], box[4]);
    const PixelRange range =
        pixel_range(picture.frame, picture.clip, corner[0], corner[1], corner[2]);
    out.put(static_cast<std::uint32_t>(range.x0 + 4 * range.y1), range.nearest, range.is_empty());
    out.put(static_cast<std::uint64_t>(range.area()));
    std::uint32_t lost[SmallPicture::kPixels], count = 0;
    for (std::uint32_t i = 0; i < SmallPicture::kPixels; ++i)
      if (look_at_border(resolve, i)) lost[count++] = i;
    const auto number = [&](std::size_t i) { return std::uint64_t{lost[i]}; };
    const RaySetup ray = ray_of(resolve, 4);
    out.put(count, std::uint64_t{first_not_below(number, count, 5)}, look(resolve, ray, 1),
            ray.shear_x);
    out.put(pixel_at(resolve, corner[0]));
    std::uint32_t shown[SmallPicture::kPixels];
    for (std::uint32_t i = 0; i < SmallPicture::kPixels; ++i)
      shown[i] = resolved_pixel(picture.before[i], picture.sight[i]);
    for (std::uint32_t i = 0; i < SmallPicture::kPixels; ++i)
      out.put(look_around(resolve, View<const std::uint32_t>(shown, SmallPicture::kPixels), i));
    for (std::uint32_t i = 0; i < SmallPicture::kPixels; ++i) {
      out.put(seen_now(&picture.sight[i]));
      out.put(resolved_pixel(picture.before[i], picture.sight[i]));
    }
  }
};

}  // namespace raysheaf::test
