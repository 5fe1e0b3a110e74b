// Rays that begin far outside the scene. In binary32 the distance to a box has an error of u times
// the distance, which may exceed the box. So the origin moves along the ray, in binary64, to where
// the ray enters the scene's box: box tests begin there, at s0.
//
//     o - - - - - - - - - - - - - -  +----------+         s of the ray
//     |<----------- s0 ----------->  o''---->   |         s - s0: `s` of box tests
//                                    +----------+
//
// With the slopes and s0 as the doubles that they are, o + s0 k is computed in binary64 with an
// error of less than w = 2^-48 (|o| + h), where h is the largest coordinate of the scene, and
// rounded to binary32 with an error of u |o''|. Subtracting the pad from o'' rounds by as much. So
// `pad` is 4 u |o''| + w, and the least of `Growth`. s0 and the end of the ray are found with the
// box grown by w and that least, which covers the roundings of s0, too: every hit has s0 <= s.
//
// Stage 1 of the test with a triangle (intersect/triangle_body.h) rejects from there, too. A
// sheared corner is then wrong by 2 pad more, which adds at most 8 r pad + 8 pad^2 + 8 E pad to the
// error of an edge function: less than Y larger by pad / 4 u does. Triangles that are not rejected
// go to stage 2, with the ray as it is.
#pragma once

#include <cmath>
#include <limits>

#include "methods/dual/bundle16.h"
#include "scene/placing.h"

namespace raysheaf {

struct FarRay {
  Vec3 origin;  ///< o''
  float pad;    ///< by which boxes grow
  float s_far;  ///< from there; below 0: the ray misses the scene
  /// At most s0, less what t loses when it is rounded: s - s0 is at most `past(t, along)` - start.
  float start;
};
/// Times the pad, this is added to Y.
inline constexpr float kDepthOfPad = 0x1p22f;

/// How far a point is outside a box, along the axis where that is farthest; below 0 inside.
[[nodiscard]] RAYSHEAF_HD inline float distance_outside(Vec3 p, const Box& box) {
  return max_component(max(box.min - p, p - box.max));
}

/// Where a ray is, in s at least and at most.
struct FarSpan {
  double enter, leave;

  /// `along`: |d_z|. The interval is [t_min, t_max], 0 <= t_min.
  RAYSHEAF_HD FarSpan(float t_min, float t_max, double along) {
    constexpr double kRounding = kUnitRoundoff;
    const double begin = t_min < kLargeStart ? double{t_min} : 0;
    enter = (begin - double{kLeastStep}) * along * (1 - 8 * kRounding);
    leave = (double{t_max} + double{kLeastStep}) * along * (1 + 8 * kRounding);
  }
};

/// A ray from the point where it enters; `off`: by which boxes grow in binary64.
[[nodiscard]] RAYSHEAF_HD inline FarRay far_ray(const FarSpan& span, Vec3 origin, double off) {
  constexpr double kRounding = kUnitRoundoff, kFloats = 1e38;
  const auto lesser = [](double a, double b) { return a < b ? a : b; };
  const float pad = 4 * kUnitRoundoff * max_component(abs(origin)) +
                    static_cast<float>(off) * (1 + 2 * kUnitRoundoff);
  // `past` rounds products that are near s0 three times, and a difference once.
  const double start = lesser(span.enter - 4 * kRounding * std::fabs(span.enter), kFloats);
  const double far = (span.leave - span.enter) * (1 + 4 * kRounding) + off;
  return {origin, pad, static_cast<float>(lesser(far, kFloats)),
          static_cast<float>(start > -kFloats ? start : -kFloats)};
}

/// Moves the origin to where the ray enters the box; `along`: |d_z|, which may be rounded where the
/// direction was given as floats. The interval is [t_min, t_max], 0 <= t_min.
[[nodiscard]] RAYSHEAF_HD inline FarRay move_origin(const LongRay& ray, float t_min, float t_max,
                                                    double along, const Box& box) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto greater = [](double a, double b) { return a > b ? a : b; };
  const auto lesser = [](double a, double b) { return a < b ? a : b; };
  const double off = ray.error + double{Growth(box).least};
  FarSpan span(t_min, t_max, along);
  const double per_along = 1 / along;
  double slope[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    const double low = component(box.min, axis) - off - o;
    const double high = component(box.max, axis) + off - o;
    slope[axis] = d * per_along;
    if (d == 0) {
      if (low > 0 || high < 0) return {{}, 0, -kInfinity, 0};
      continue;
    }
    const double to_low = low * (along / d), to_high = high * (along / d);
    span.enter = greater(span.enter, lesser(to_low, to_high));
    span.leave = lesser(span.leave, greater(to_low, to_high));
  }
  if (!(span.enter <= span.leave)) return {{}, 0, -kInfinity, 0};
  const auto at = [&](int axis) {
    return static_cast<float>(ray.origin[axis] + span.enter * slope[axis]);
  };
  return far_ray(span, {at(0), at(1), at(2)}, off);
}

/// A ray as it is given, for a box of the scene.
[[nodiscard]] RAYSHEAF_HD inline LongRay long_ray(const Ray& ray, const Box& scene) {
  const Vec3 o = ray.origin, d = ray.direction;
  const double from = max_component(abs(o));
  const double h = max_component(max(abs(scene.min), abs(scene.max)));
  return {{o.x, o.y, o.z}, {d.x, d.y, d.z}, 0x1p-48 * (from + h)};
}

}  // namespace raysheaf
