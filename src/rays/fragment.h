// A place where light is gathered: what a primary or a secondary ray met.
#pragma once

#include "raysheaf/large_vector.h"
#include "surface/surface.h"

namespace raysheaf {

struct Fragment {
  Surface surface;
  Vec3 incoming;         ///< unit direction of the ray that arrived
  Vec3 weight{1, 1, 1};  ///< what the pixel receives of the radiance that leaves here
  std::uint32_t pixel = 0;
  std::uint32_t path = 0;  ///< 0 at the first hit; then a number for the bounces that led here
  std::uint32_t triangle = kInvalidId;
};

/// `resize` touches none: who makes fragments assigns each whole.
using Fragments = LargeVector<Fragment>;

/// A fragment before its surface is fetched, which only those without a triangle have by then.
/// `incoming`: of a first hit it is fetched, too.
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
