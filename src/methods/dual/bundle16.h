// The data that the sixteen rays of a bundle share: the axes of their quarter, and their beam.
//
// All rays point towards one quarter of a face, so they share the axes (x, y across, z along) of
// `make_ray_setup` and which planes of a box are near. `s` is the distance from a ray's origin
// along z, t = s |shear_z|; `zeta` is the distance from the beam's first plane. For rays that point
// against their axis, z is mirrored.
//
// Tests are conservative. If a ray hits a triangle, then in exact arithmetic its line is in the
// triangle's box at some s, and t is s / |d_z| rounded to within 1.25 u
// (intersect/triangle_body.h). So a box test may be wrong by its own roundings only, and these grow
// with the distance from the ray to the box, not with the size of the scene (T. Ize, "Robust BVH
// Ray Traversal", JCGT 2(2), 2013):
//
//   s of a plane     (plane - o) / slope has four roundings: two of the inverse slope, one of the
//                    difference, one of the product. The sign is exact. So the s at which a ray
//                    leaves a box, times kFarther, is at least the s at which it enters.
//   slopes near 0    are replaced by kLeastSlope. The s at which the ray enters then is too small,
//                    but the ray might leave too early: planes are moved outwards, by `Growth`,
//                    far enough that even so it leaves behind all that may be hit.
//   t that underflows  has an additional error of up to 2^-149, two halves of the least number,
//                    which a long direction magnifies: `past` and its counterpart move t by twice
//                    that. From kLargeStart on t_min does not bound s, because t may overflow.
//                    So s may be below 0, where kFarther is of no use: `Growth` is more than that.
//
// A beam is described in coordinates of the scene, so it also has an error of u times the
// coordinates: `beam_pad`. With C the largest coordinate of the origins, and Z the largest |zeta|
// of an origin, its planes at zeta = 0 are wrong by at most 2.1 u C + 6.2 u Z, and where rays begin
// and end by less. Their slopes are wrong by 8.2 u, and a plane's zeta by 3.1 u of itself, which is
// as if the slope were, because slopes are at most 1: kBeamTilt.
//
// All of this holds for rays near the scene (`is_far`), and for scenes whose coordinates are at
// most 1e18, as the library demands. The origins of other rays are moved (methods/dual/far_ray.h).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/float.h"
#include "base/host_device.h"
#include "base/vec.h"
#include "methods/dual/dual.h"

namespace raysheaf {

inline constexpr std::uint32_t kBundleWidth = 16;
inline constexpr float kFarther = 1 + 12 * kUnitRoundoff;
inline constexpr float kLeastSlope = 0x1p-100f;
inline constexpr float kLeastStep = 0x1p-148f;
inline constexpr float kLargeStart = 0x1p63f;
inline constexpr float kBeamTilt = 16 * kUnitRoundoff;
/// Rays that begin this many lengths of the scene outside it are far.
inline constexpr float kFarLengths = 64;

/// How far a box's planes are moved outwards: a plane at x by |x| times 2 u, which is more than it
/// loses when it is rounded, and by `least`. Times 1 / kLeastSlope that exceeds every s within the
/// scene of a ray that is near it, 2^8 times its length.
struct Growth {
  float least = 0;

  Growth() = default;
  RAYSHEAF_HD explicit Growth(const Box& scene)
      : least(max_component(scene.max - scene.min) * 0x1p-73f + 0x1p-140f) {}
  /// For rays whose |d_z| is at most `along`.
  RAYSHEAF_HD void include(float along) { least += along * 0x1p-100f * 0x1p-46f; }
  [[nodiscard]] RAYSHEAF_HD float of(float plane) const {
    return std::fabs(plane) * (2 * kUnitRoundoff) + least;
  }
};

/// C and Z as above. `start`: where the first ray begins, which may be below 0.
[[nodiscard]] inline float beam_pad(float coordinate, float zeta, float start,
                                    const Growth& growth) {
  const float before = start < 0 ? -2 * kBeamTilt * start : 0;
  return 8 * kUnitRoundoff * (coordinate + zeta) + before + growth.least;
}

/// The axes that all rays towards one quarter of a face (methods/dual/ray_order.h) share.
struct QuarterAxes {
  int axis_x = 0, axis_y = 0, axis_z = 0;
  int near_x = 0, near_y = 0, near_z = 0;  ///< a node's rows of the planes that rays intersect
                                           ///< first
  int far_x = 0, far_y = 0, far_z = 0;
  bool mirrored = false;

  constexpr QuarterAxes() = default;
  constexpr explicit QuarterAxes(std::uint32_t quarter) {
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
  [[nodiscard]] Vec3 along_axes(Vec3 v) const {
    return {component(v, axis_x), component(v, axis_y), component(v, axis_z)};
  }
};

inline constexpr std::array<QuarterAxes, kQuarters> kAxesOfQuarters = [] {
  std::array<QuarterAxes, kQuarters> all;
  for (std::uint32_t quarter = 0; quarter < kQuarters; ++quarter)
    all[quarter] = QuarterAxes(quarter);
  return all;
}();

/// The s beyond which no hit is as near as t: `along` is |d_z|.
[[nodiscard]] RAYSHEAF_HD inline float past(float t, float along) {
  return (t + kLeastStep) * along * (1 + 8 * kUnitRoundoff);
}

/// One of the beam's four planes: x = at + zeta / inverse, moved and tilted outwards.
struct BeamPlane {
  float at, inverse;
};

struct alignas(64) Beam {
  float z_low, z_high;  ///< the first plane's coordinate -+ pad
  float start, end;     ///< in zeta
  BeamPlane x_low, x_high, y_low, y_high;
};

}  // namespace raysheaf
