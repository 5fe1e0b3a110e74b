// One pixel of the resolve: who its neighbours are, and what its ray sees.
#pragma once

#include <cstdint>

#include "base/bits.h"
#include "base/view.h"
#include "intersect/triangle_body.h"
#include "raygen/camera_body.h"
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
  return SightKey{float_bits(t + 0.0f)} << 32 | triangle;  // + 0 takes the sign from -0
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

/// What the ray sees of one triangle.
inline SightKey look(const FlatScene& scene, const RaySetup& ray, std::uint32_t triangle) {
  TriangleHit hit;
  const bool seen = intersect_triangle(ray, scene.corner(triangle, 0), scene.corner(triangle, 1),
                                       scene.corner(triangle, 2), &hit) &&
                    shows_side(scene.flags[triangle], hit.front);
  return seen ? sight_key(hit.t, triangle) : kSeesNothing;
}

/// Whether the 3 x 3 pixels around one, none of them outside of the picture, hold the same.
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

}  // namespace raysheaf
