// One ray's sort key, for every RayKey that is a position on a curve.
//
//   kd+L-1 ....... kd kd-1 ................................ 0     k bits per axis, d axes
//   | light, L bits  | place of the ray's cell in d axes   |
//
// Only shadow rays have a light. The axes, d of them:
//
//   pixel        2   column and row of the pixel
//   spherical    2   azimuth and polar angle of the direction; noise for directional lights
//   octahedral   2   the octahedral map of the direction, or the place on a
//                    directional light's disc
//   end point    3   where the ray ends
//   five         5   the octahedral map of the direction, as above; where it starts
//   two points   6   where the ray starts; where it ends
//
// A ray starts where it enters the scene's box and ends where it leaves it, or at its own ends if
// they are inside.
#pragma once

#include <cassert>
#include <cmath>
#include <cstdint>

#include "base/bits.h"
#include "base/vec.h"
#include "rays/ray_place_body.h"
#include "raysheaf/method.h"

namespace raysheaf {

/// The resolution of a float in [0, 1].
inline constexpr std::uint32_t kMostAxisBits = 24;

struct KeyLayout {
  std::uint32_t light_bits = 0, axes = 2, axis_bits = 0;
  [[nodiscard]] RAYSHEAF_HD std::uint32_t bits() const { return light_bits + axes * axis_bits; }
};

/// As many bits per axis as fit into `key_bits` next to the light, and no more than are useful.
RAYSHEAF_HD inline KeyLayout key_layout(std::uint32_t lights, std::uint32_t axes,
                                        std::uint32_t key_bits, std::uint32_t most_axis_bits) {
  assert(axes > 0);
  KeyLayout layout;
  layout.light_bits = bits_for(lights);
  layout.axes = axes;
  const std::uint32_t room = (key_bits - layout.light_bits) / axes;
  layout.axis_bits = room < most_axis_bits ? room : most_axis_bits;
  return layout;
}

RAYSHEAF_HD inline Vec2 spherical(Vec3 direction) {
  constexpr float kHalfTurn = 3.14159265359f;
  const Vec3 d = normalized(direction);
  // In binary64, rounded: those of binary32 differ from processor to processor.
  const auto azimuth = static_cast<float>(std::atan2(double{d.y}, double{d.x}));
  const auto polar = static_cast<float>(std::acos(double{clamp(d.z, -1, 1)}));
  return {azimuth / (2 * kHalfTurn) + 0.5f, polar / kHalfTurn};
}

/// Data shared by all rays of a batch.
struct KeyContext {
  KeyCell cell = KeyCell::kOctahedral;
  bool hilbert = true;
  KeyLayout layout;
  KeyCube cube;
  std::uint32_t width = 1;       ///< of the image
  std::uint32_t pixel_bits = 0;  ///< of a pixel's column and row
};

/// One ray of the batch.
struct KeyedRay {
  Ray ray;
  Vec2 square;  ///< the direction on the unit square, or the place on a directional light's disc
  std::uint32_t pixel = 0, light = 0;  ///< lights count from the batch's first
};

template <int kDimensions>
RAYSHEAF_HD inline std::uint64_t place_on_curve(const KeyContext& context,
                                                const Cell<kDimensions>& cell) {
  return context.hilbert ? hilbert_place(cell, context.layout.axis_bits) : morton_place(cell);
}

/// The upper bits of a pixel's column and row.
RAYSHEAF_HD inline Cell<2> pixel_cell(const KeyContext& context, std::uint32_t pixel) {
  const std::uint32_t drop = context.pixel_bits - context.layout.axis_bits;
  return {{(pixel / context.width) >> drop, (pixel % context.width) >> drop}};
}

RAYSHEAF_HD inline std::uint64_t curve_place(const KeyContext& context, const KeyedRay& r) {
  const std::uint32_t bits = context.layout.axis_bits;
  switch (context.cell) {
    case KeyCell::kNone:
      break;
    case KeyCell::kPixel:
      return place_on_curve(context, pixel_cell(context, r.pixel));
    case KeyCell::kSpherical:
      return place_on_curve(context, square_cell(spherical(r.ray.direction), bits));
    case KeyCell::kOctahedral:
      return place_on_curve(context, square_cell(r.square, bits));
    case KeyCell::kEnd:
      return place_on_curve(context,
                            cube_cell(context.cube, ray_ends(context.cube.box, r.ray).end, bits));
    case KeyCell::kOctahedralAndStart: {
      const Vec3 start = ray_ends(context.cube.box, r.ray).start;
      return place_on_curve(
          context, joined(square_cell(r.square, bits), cube_cell(context.cube, start, bits)));
    }
    case KeyCell::kStartAndEnd: {
      const RayEnds ends = ray_ends(context.cube.box, r.ray);
      return place_on_curve(context, joined(cube_cell(context.cube, ends.start, bits),
                                            cube_cell(context.cube, ends.end, bits)));
    }
  }
  return 0;
}

RAYSHEAF_HD inline std::uint64_t curve_key(const KeyContext& context, const KeyedRay& r) {
  const std::uint32_t below = context.layout.axes * context.layout.axis_bits;
  assert(below + context.layout.light_bits <= 64);
  const std::uint64_t light = context.layout.light_bits == 0 ? 0 : std::uint64_t{r.light} << below;
  return light | curve_place(context, r);
}

}  // namespace raysheaf
