// One pixel of the resolve.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "intersect/triangle_body.h"
#include "raygen/camera_body.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// Whether a camera sees a triangle from the side that `front` names.
RAYSHEAF_HD inline bool shows_side(std::uint8_t flags, bool front) {
  return (flags & kSingleSided) == 0 || front == ((flags & kMirrored) == 0);
}

/// The distinct ids of the (up to) 3 x 3 pixels around one.
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

/// What the ray sees among the candidates; `kept` is the answer where it hits none of them.
template <class Corner>
RAYSHEAF_HD std::uint32_t nearest_of(const Neighbourhood& near, const Ray& ray,
                                     const Corner& corner, const std::uint8_t* flags,
                                     std::uint32_t kept) {
  const RaySetup setup = make_ray_setup(ray);
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t nearest = kInvalidId;
  for (std::uint32_t i = 0; i < near.count; ++i) {
    const std::uint32_t id = near.ids[i];
    TriangleHit hit;
    if (id == kInvalidId) {
      kept = kInvalidId;
    } else if (intersect_triangle(setup, corner(id, 0), corner(id, 1), corner(id, 2), &hit) &&
               shows_side(flags[id], hit.front) && (hit.t < t || (hit.t == t && id < nearest))) {
      t = hit.t;
      nearest = id;
    }
  }
  return nearest != kInvalidId ? nearest : kept;
}

}  // namespace raysheaf
