// The resolve for each pixel and triangle: the neighbours of a pixel, what its ray sees, and which
// pixels test a triangle. Sights are only lowered, so their order does not matter.
#pragma once

#include <cstdint>

#include "base/bits.h"
#include "base/search.h"
#include "base/view.h"
#include "exec/atomic.h"
#include "intersect/triangle_body.h"
#include "render/raster/pack_body.h"
#include "render/raster/pixel_range.h"
#include "render/rays/camera_body.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// (t, number) in the order of integers:
///
///      63         32 31           0
///     +-------------+--------------+
///     | bits of t   | triangle     |
///     +-------------+--------------+
using SightKey = std::uint64_t;

inline constexpr SightKey kSeesNothing = SightKey{0x7f800000u} << 32 | kInvalidId;
inline constexpr SightKey kNotLooked = ~SightKey{0};

RAYSHEAF_HD inline SightKey sight_key(float t, std::uint32_t triangle) {
  return SightKey{float_bits(t + 0.0f)} << 32 | triangle;  // + 0 removes the sign of -0
}
RAYSHEAF_HD inline std::uint32_t triangle_of(SightKey key) {
  return static_cast<std::uint32_t>(key);
}

RAYSHEAF_HD inline float distance_of(SightKey key) {
  return bits_float(static_cast<std::uint32_t>(key >> 32));
}

/// Whether a camera sees a triangle from the side that `front` names.
RAYSHEAF_HD inline bool shows_side(std::uint8_t flags, bool front) {
  return (flags & kSingleSided) == 0 || front == ((flags & kMirrored) == 0);
}

/// Whether the 3 x 3 pixels around one, all of them inside the image, hold the same triangle.
RAYSHEAF_HD inline bool is_uniform(const std::uint32_t* pixel, std::size_t width) {
  const std::uint32_t id = *pixel;
  const std::uint32_t *above = pixel - width, *below = pixel + width;
  return ((pixel[-1] ^ id) | (pixel[1] ^ id) | (above[-1] ^ id) | (above[0] ^ id) |
          (above[1] ^ id) | (below[-1] ^ id) | (below[0] ^ id) | (below[1] ^ id)) == 0;
}

/// The distinct triangles of the (up to) 3 x 3 pixels around one, its own first.
struct Neighbourhood {
  std::uint32_t ids[9];
  std::uint32_t count = 0;

  RAYSHEAF_HD void add(std::uint32_t id) {
    for (std::uint32_t i = 0; i < count; ++i) {
      if (ids[i] == id) return;
    }
    ids[count++] = id;
  }
};

RAYSHEAF_HD inline Neighbourhood neighbourhood(View<const std::uint32_t> picture,
                                               std::uint32_t width, std::uint32_t height,
                                               std::uint32_t x, std::uint32_t y) {
  const std::uint32_t x0 = x > 0 ? x - 1 : 0, x1 = x + 1 < width ? x + 1 : x;
  const std::uint32_t y0 = y > 0 ? y - 1 : 0, y1 = y + 1 < height ? y + 1 : y;
  Neighbourhood near;
  near.add(picture[std::size_t{y} * width + x]);
  for (std::uint32_t j = y0; j <= y1; ++j) {
    for (std::uint32_t i = x0; i <= x1; ++i) near.add(picture[std::size_t{j} * width + i]);
  }
  return near;
}

/// An image that is being resolved. `Triangles` has `corner(triangle, k)` and `flags_of(triangle)`.
template <class Triangles>
struct Resolve {
  PictureView view;
  Triangles triangles;
  View<const std::uint32_t> before;  ///< the original image
  SightKey* sight;                   ///< of each pixel; initially `kNotLooked`
};

/// Triangles that span up to this many pixels are tested with all of them.
inline constexpr std::int64_t kFewPixels = 16;

template <class Triangles>
RAYSHEAF_HD inline RaySetup ray_of(const Resolve<Triangles>& r, std::size_t pixel) {
  const std::uint32_t width = r.view.frame.width;
  return make_ray_setup(camera_ray(r.view.frame, static_cast<std::uint32_t>(pixel % width),
                                   static_cast<std::uint32_t>(pixel / width)));
}

/// The sight of one triangle for a ray.
template <class Triangles>
RAYSHEAF_HD inline SightKey look(const Resolve<Triangles>& r, const RaySetup& ray,
                                 std::uint32_t triangle) {
  const Triangles& all = r.triangles;
  TriangleHit hit;
  const bool seen = intersect_triangle(ray, all.corner(triangle, 0), all.corner(triangle, 1),
                                       all.corner(triangle, 2), &hit) &&
                    shows_side(all.flags_of(triangle), hit.front);
  return seen ? sight_key(hit.t, triangle) : kSeesNothing;
}

/// Tests a pixel at a border with the triangles around it. Returns whether its ray does not hit the
/// triangle that it held. A pixel among eight with the same triangle is deep inside that triangle,
/// which is convex; at the image's edge this is not known.
template <class Triangles>
RAYSHEAF_HD inline bool look_at_border(const Resolve<Triangles>& r, std::size_t pixel) {
  const std::uint32_t width = r.view.frame.width, height = r.view.frame.height;
  const auto x = static_cast<std::uint32_t>(pixel % width);
  const auto y = static_cast<std::uint32_t>(pixel / width);
  const bool at_edge = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
  if (!at_edge && is_uniform(&r.before.data[pixel], width)) return false;
  const Neighbourhood near = neighbourhood(r.before, width, height, x, y);
  const RaySetup ray = ray_of(r, pixel);
  SightKey nearest = kSeesNothing;
  bool lost = false;
  for (std::uint32_t i = 0; i < near.count; ++i) {
    if (near.ids[i] == kInvalidId) continue;
    const SightKey seen = look(r, ray, near.ids[i]);
    nearest = seen < nearest ? seen : nearest;
    lost = lost || (i == 0 && seen == kSeesNothing);
  }
  r.sight[pixel] = nearest;
  return lost;
}

/// Tests a pixel with a triangle that its neighbours may not hold.
template <class Triangles>
RAYSHEAF_HD inline void look_from_pixel(const Resolve<Triangles>& r, std::uint32_t triangle,
                                        float nearest, std::size_t pixel) {
  const std::uint32_t held = r.before.data[pixel];
  if (held == triangle) return;
  const SightKey known = seen_now(&r.sight[pixel]);
  if (known != kNotLooked && distance_of(known) < nearest) return;
  const RaySetup ray = ray_of(r, pixel);
  const SightKey seen = look(r, ray, triangle);
  if (seen == kSeesNothing) return;
  lower_to(&r.sight[pixel], seen);
  // A known sight already includes the triangle that the pixel held.
  if (known == kNotLooked && held != kInvalidId) lower_to(&r.sight[pixel], look(r, ray, held));
}

/// The pixel at a triangle's centroid, relative to the eye; kInvalidId if it is not in the image.
template <class Triangles>
RAYSHEAF_HD inline std::uint32_t pixel_at(const Resolve<Triangles>& r, Vec3 p) {
  const ClipMatrix& m = r.view.clip;
  const float w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
  const auto place = [&](int axis, std::uint32_t count) {
    const float sum = m[axis] * p.x + m[4 + axis] * p.y + m[8 + axis] * p.z;
    return (sum / w + 1) * 0.5f * static_cast<float>(count);
  };
  const std::uint32_t width = r.view.frame.width, height = r.view.frame.height;
  const float x = place(0, width), y = place(1, height);
  if (!(w > 0 && x >= 0 && y >= 0 && x < static_cast<float>(width) &&
        y < static_cast<float>(height)))
    return kInvalidId;
  return static_cast<std::uint32_t>(y) * width + static_cast<std::uint32_t>(x);
}

/// Tests a triangle with the pixels that may have missed it: all that it spans, if they are few,
/// otherwise the one at its centroid and those of `lost`, which ascend.
template <class Triangles>
RAYSHEAF_HD inline void look_for(const Resolve<Triangles>& r, View<const std::uint32_t> lost,
                                 std::uint32_t triangle) {
  const CameraFrame& frame = r.view.frame;
  const Vec3 a = r.triangles.corner(triangle, 0) - frame.eye;
  const Vec3 b = r.triangles.corner(triangle, 1) - frame.eye;
  const Vec3 c = r.triangles.corner(triangle, 2) - frame.eye;
  if (!may_show(r.view, a, b, c, r.triangles.flags_of(triangle))) return;
  const PixelRange range = pixel_range(frame, r.view.clip, a, b, c);
  if (range.is_empty()) return;
  const bool few = range.area() <= kFewPixels;
  if (!few) {
    const std::uint32_t pixel = pixel_at(r, (a + b + c) * (1.0f / 3));
    if (pixel != kInvalidId) look_from_pixel(r, triangle, range.nearest, pixel);
    if (lost.size == 0) return;
  }
  for (std::int32_t y = range.y0; y <= range.y1; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * frame.width;
    const std::size_t first = row + static_cast<std::size_t>(range.x0);
    const std::size_t last = row + static_cast<std::size_t>(range.x1);
    if (few) {
      for (std::size_t pixel = first; pixel <= last; ++pixel)
        look_from_pixel(r, triangle, range.nearest, pixel);
      continue;
    }
    const auto number = [&](std::size_t i) { return std::uint64_t{lost.data[i]}; };
    for (std::size_t i = first_not_below(number, lost.size, first);
         i < lost.size && lost.data[i] <= last; ++i)
      lower_to(&r.sight[lost.data[i]], look(r, ray_of(r, lost.data[i]), triangle));
  }
}

/// Tests a pixel with those triangles that the pixels around it show, but did not hold at first.
/// `shown`: the triangles of all pixels so far. Returns the triangle that the pixel shows then.
///
/// Where surfaces coincide, OpenGL may draw the wrong one in whole regions, whose pixels all hold
/// the same triangle. Wherever a pixel of the region is found to be wrong, its neighbours are
/// tested, and so on.
template <class Triangles>
RAYSHEAF_HD inline std::uint32_t look_around(const Resolve<Triangles>& r,
                                             View<const std::uint32_t> shown, std::size_t pixel) {
  const std::uint32_t width = r.view.frame.width, height = r.view.frame.height;
  const auto x = static_cast<std::uint32_t>(pixel % width);
  const auto y = static_cast<std::uint32_t>(pixel / width);
  const bool at_edge = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
  const std::uint32_t own = shown.data[pixel];
  if (!at_edge && is_uniform(&shown.data[pixel], width)) return own;
  const Neighbourhood tested = neighbourhood(r.before, width, height, x, y);
  const Neighbourhood near = neighbourhood(shown, width, height, x, y);
  SightKey nearest = r.sight[pixel];
  for (std::uint32_t i = 1; i < near.count; ++i) {  // the first is its own
    bool is_new = near.ids[i] != kInvalidId;
    for (std::uint32_t k = 0; k < tested.count; ++k)
      is_new = is_new && tested.ids[k] != near.ids[i];
    if (!is_new) continue;
    const RaySetup ray = ray_of(r, pixel);
    if (nearest == kNotLooked && own != kInvalidId) nearest = look(r, ray, own);
    const SightKey seen = look(r, ray, near.ids[i]);
    nearest = seen < nearest ? seen : nearest;
  }
  if (nearest == r.sight[pixel] || nearest == kSeesNothing) return own;
  r.sight[pixel] = nearest;
  return triangle_of(nearest);
}

/// The triangle of the pixel before `look_around`.
RAYSHEAF_HD inline std::uint32_t resolved_pixel(std::uint32_t before, SightKey sight) {
  return sight != kNotLooked ? triangle_of(sight) : before;
}

}  // namespace raysheaf
