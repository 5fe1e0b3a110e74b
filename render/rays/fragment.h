// A point where light is gathered: a hit of a primary or a secondary ray.
#pragma once

#include "raysheaf/large_vector.h"
#include "render/surface/surface.h"

namespace raysheaf {

struct Fragment {
  Surface surface;
  Vec3 incoming;         ///< unit direction of the arriving ray
  Vec3 weight{1, 1, 1};  ///< factor with which the radiance from here is added to the pixel
  std::uint32_t pixel = 0;
  std::uint32_t path = 0;  ///< 0 at the primary hit; then a number for the bounces that led here
  std::uint32_t triangle = kInvalidId;
};

/// `resize` leaves elements uninitialized: code that makes fragments assigns each as a whole.
using Fragments = LargeVector<Fragment>;

/// Initializes a fragment before its surface is fetched; without a triangle it has none. `incoming`
/// of a primary hit is also set later.
inline void begin_fragment(Fragment* fragment, std::uint32_t triangle, std::uint32_t pixel) {
  if (triangle == kInvalidId) {
    *fragment = {};
  } else {
    fragment->path = 0;
    fragment->weight = {1, 1, 1};
  }
  fragment->triangle = triangle;
  fragment->pixel = pixel;
}

}  // namespace raysheaf
