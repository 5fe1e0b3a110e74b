// Tests whether a moving box intersects a box, for shafts and frusta.
//
// Both are swept by a box whose sides move at constant speeds, t from 0 to 1: from O to E for a
// shaft, from O by t T D for a frustum of slopes D and reach T. At t it intersects B if on each
// axis
//
//    O.min + t v.min <= B.max    and    O.max + t v.max >= B.min
//
// that is, if six gaps that close at constant speeds are still open:
//
//    gap - t speed >= 0:   (B.max - O.min, v.min)  and  (O.max - B.min, -v.max)  on each axis
//
// Each bounds t from one side. A single t satisfies all of them exactly if the swept volume
// intersects B: the moving box is convex, so that no other planes are needed.
//
// Rounding. L, the largest gap, is at least any coordinate of a corner of B relative to an origin.
// A hit has a point of its ray before the end within gamma(2) L of B on every axis
// (geom/ray_end.h), a frustum's scaled directions move that by gamma(2) L, a gap is rounded by
// gamma(1) L and by as much when the slack is added: 64 u L is sufficient. kTinySlack covers
// underflow, and keeps a gap that is open at a speed of zero wide enough for the reciprocal that
// stands for infinity. Quotients err by gamma(4), which the last comparison allows for.
#pragma once

#include <cmath>

#include "geom/shaft.h"

namespace raysheaf {

inline constexpr float kBeamSlack = 64 * kUnitRoundoff;
inline constexpr float kBeamLoosened = 1 + 16 * kUnitRoundoff;
inline constexpr float kLargestReciprocal = 0x1p100f;

struct BeamTest {
  Box origins;
  Vec3 per_min, per_max;  ///< reciprocals of the six speeds; positive ones bound t from above
};

RAYSHEAF_HD inline float reciprocal_of_speed(float speed) {
  if (speed == 0) return kLargestReciprocal;
  return clamp(1 / speed, -kLargestReciprocal, kLargestReciprocal);
}

RAYSHEAF_HD inline Vec3 reciprocal_of_speed(Vec3 speed) {
  return {reciprocal_of_speed(speed.x), reciprocal_of_speed(speed.y), reciprocal_of_speed(speed.z)};
}

RAYSHEAF_HD inline BeamTest make_beam_test(const Box& origins, Vec3 speed_min, Vec3 speed_max) {
  return {origins, reciprocal_of_speed(speed_min), reciprocal_of_speed(-speed_max)};
}

RAYSHEAF_HD inline BeamTest make_node_test(const Shaft& shaft) {
  return make_beam_test(shaft.origins, shaft.ends.min - shaft.origins.min,
                        shaft.ends.max - shaft.origins.max);
}

RAYSHEAF_HD inline Box box_of_triangle(Vec3 a, Vec3 b, Vec3 c) {
  return {min(min(a, b), c), max(max(a, b), c)};
}

/// Clips [lo, hi] to where the gap is open.
RAYSHEAF_HD inline void clip(float gap, float per_speed, float* lo, float* hi) {
  const float t = gap * per_speed;
  if (per_speed > 0) {
    *hi = t < *hi ? t : *hi;
  } else {
    *lo = t > *lo ? t : *lo;
  }
}

/// The slack that is added to all gaps.
RAYSHEAF_HD inline float beam_slack(Vec3 gap_min, Vec3 gap_max) {
  return kBeamSlack * max_component(max(gap_min, gap_max)) + kTinySlack;
}

RAYSHEAF_HD inline bool meets(const BeamTest& node, const Box& box) {
  const Vec3 gap_min = box.max - node.origins.min, gap_max = node.origins.max - box.min;
  const float slack = beam_slack(gap_min, gap_max);
  float lo = 0, hi = 1;
  clip(gap_min.x + slack, node.per_min.x, &lo, &hi);
  clip(gap_max.x + slack, node.per_max.x, &lo, &hi);
  clip(gap_min.y + slack, node.per_min.y, &lo, &hi);
  clip(gap_max.y + slack, node.per_max.y, &lo, &hi);
  clip(gap_min.z + slack, node.per_min.z, &lo, &hi);
  clip(gap_max.z + slack, node.per_max.z, &lo, &hi);
  return lo <= hi * kBeamLoosened;
}

}  // namespace raysheaf
