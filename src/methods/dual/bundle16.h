// The data that the sixteen rays of a bundle share: the axes of their quarter, and their beam.
// them.
//
// All rays point towards one quarter of a face, so they share the axes (x, y across, z along) of
// `make_ray_setup` and which planes of a box are near. `s` is the distance from a ray's origin
// along z, t = s |shear_z|; `zeta` is the distance from the beam's first plane. For rays that point
// against their axis, z is mirrored.
//
// Tests are conservative: a hit at t is, at s = t |d_z|, within gamma(2) L of the triangle on every
// axis (geom/ray_end.h), where L is at most `size`, twice the reach of the scene's box from the
// origins. The slab and beam tests have three roundings of differences that are at most `size`, and
// use rounded coordinates. Each rounding moves a plane by at most u times `size` or u times the
// largest coordinate; slopes are at most 1 because z is the dominant axis. `pad`, 128 u `size` and
// 8 u the largest coordinate, is more than the sum of these errors. Boxes grow by it on every side,
// through the rays' constants.
//
// A t that underflows has an additional error of up to 2^-149, two halves of the least number,
// which a long direction magnifies: `past` and its counterpart move t by twice that. A t that
// overflows is infinite, and so is 1 / |d_z| below 2^-128: then s is smaller than t implies, and
// from kLargeStart on t_min does not bound s. Below kLargeStart, if 1 / |d_z| is infinite, t_min is
// at most 2^-65 in s.
#pragma once

#include <cstdint>

#include "base/float.h"
#include "methods/dual/dual.h"

namespace raysheaf {

inline constexpr std::uint32_t kBundleWidth = 16;
/// Larger coordinates and reaches are not bounded, because the sums above would overflow.
inline constexpr float kLargestBounded = 1e30f;
inline constexpr float kLeastStep = 0x1p-148f;
inline constexpr float kLargeStart = 0x1p63f;

/// The axes that all rays towards one quarter of a face (methods/dual/ray_order.h) share.
struct QuarterAxes {
  int axis_x = 0, axis_y = 0, axis_z = 0;
  int near_x = 0, near_y = 0, near_z = 0;  ///< a node's rows of the planes that rays intersect
                                           ///< first
  int far_x = 0, far_y = 0, far_z = 0;
  bool mirrored = false;

  QuarterAxes() = default;
  explicit QuarterAxes(std::uint32_t quarter) {
    const int along = static_cast<int>(quarter / 8), next = along == 2 ? 0 : along + 1;
    const int last = next == 2 ? 0 : next + 1;
    mirrored = (quarter & 4) != 0;
    axis_x = mirrored ? last : next;
    axis_y = mirrored ? next : last;
    axis_z = along;
    const bool left = (quarter & (mirrored ? 1 : 2)) != 0;
    const bool down = (quarter & (mirrored ? 2 : 1)) != 0;
    near_x = axis_x + (left ? 3 : 0);
    far_x = axis_x + (left ? 0 : 3);
    near_y = axis_y + (down ? 3 : 0);
    far_y = axis_y + (down ? 0 : 3);
    near_z = along + (mirrored ? 3 : 0);
    far_z = along + (mirrored ? 0 : 3);
  }
};

/// The s beyond which no hit is as near as t: `along` is |d_z|.
[[nodiscard]] inline float past(float t, float along, float pad) {
  return (t + kLeastStep) * along * (1 + 8 * kUnitRoundoff) + pad;
}

/// One of the beam's four planes: x = at + zeta / inverse, moved outwards by the pad.
struct BeamPlane {
  float at, inverse;
};

struct alignas(64) Beam {
  float z_low, z_high;  ///< the first plane's coordinate -+ pad
  float start, end;     ///< in zeta
  BeamPlane x_low, x_high, y_low, y_high;
};

}  // namespace raysheaf
