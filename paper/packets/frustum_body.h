// The bound of a packet: four planes around its dominant axis, and the box of its rays, both
// clipped to the scene (Garanzha & Loop 2010 bound packets by frusta with a dominant axis).
//
//        u |            ______ u = m a + c : no ray's end is above
//          |      _____/     |
//          |     |  packet   |           a: along the axis, u: one of the other two
//          |     |_______    |
//          |             \___|  u = m' a + c'
//          +------------------ a
//
// A plane's slope is that of the hull of the rays' lines between the first and the last position on
// the axis; its offset is then measured at the ends of all rays. Therefore, for any slope, all rays
// lie on the correct side, and a fan from a point light has planes through its outermost rays.
//
// Slack. Coordinates are relative to the origin of one of the rays, so that errors scale with
// distances inside the packet and to the triangle, not with the position in the world. Let |B| be
// the farthest corner of a box or triangle from there, and R the farthest origin of a ray, both as
// sums of components.
//   1. A ray's hit is a point of the triangle, and its t is rounded by 1.25 u: the point of the
//      line at t is within gamma(2) |A| of it, where |A| <= |B| + R is the distance of the farthest
//      corner from the ray's origin (geom/ray_end.h).
//   2. Differences and products in `meets` err by at most gamma(4) (|B| + R) (1 + |m|).
// Together they are less than kFrustumSlack (|B| + R) (1 + |m|). The ends of rays err by gamma(8)
// of the numbers of which they are sums; the bounds grow by gamma(16) of these when they are
// measured.
#pragma once

#include <cmath>

#include "base/float.h"
#include "base/vec.h"
#include "base/view.h"

namespace raysheaf {

inline constexpr float kFrustumSlack = 0x1p-14f;
inline constexpr float kFrustumTiny = 0x1p-120f;  ///< more than underflow can lose
inline constexpr float kFrustumHuge = 0x1p100f;   ///< longer rays have no bound

struct PacketFrustum {
  Vec3 origin;                            ///< origin of the coordinates below
  int axis;                               ///< the dominant axis
  float low[3], high[3];                  ///< the box, [axis of the world]
  float upper_slope[2], upper_offset[2];  ///< planes of the two axes after `axis`
  float lower_slope[2], lower_offset[2];
  float lean;    ///< 1 + the largest |slope|
  float spread;  ///< R
};

RAYSHEAF_HD inline float sum_of_sizes(Vec3 a) {
  return (std::fabs(a.x) + std::fabs(a.y)) + std::fabs(a.z);
}

/// The part of a ray that may hit anything, from `begin` to `end`.
struct RayPart {
  float begin, end;
};

/// The part of the ray inside the scene and its own interval, rounded outwards; a point if the ray
/// misses the scene.
RAYSHEAF_HD inline RayPart part_in_scene(const Ray& ray, const Box& scene) {
  const Vec3 to_min = scene.min - ray.origin, to_max = scene.max - ray.origin;
  const float slack = kFrustumSlack * (sum_of_sizes(to_min) + sum_of_sizes(to_max)) + kFrustumTiny;
  float begin = ray.t_min, end = ray.t_max;
  for (int k = 0; k < 3; ++k) {
    const float d = component(ray.direction, k);
    if (d == 0) continue;
    const float inverse = 1 / d;  // if it overflows, NaN and infinities clip nothing
    const float low = (component(to_min, k) - slack) * inverse;
    const float high = (component(to_max, k) + slack) * inverse;
    const float near = d > 0 ? low : high, far = d > 0 ? high : low;
    if (near > begin) begin = near;
    if (far < end) end = far;
  }
  return {begin, end < begin ? begin : end};
}

/// A point on a ray relative to the frustum's origin, and its error bound.
struct RayEnd {
  Vec3 at;
  float slack;
};

RAYSHEAF_HD inline RayEnd ray_end(const Ray& ray, Vec3 origin, float t) {
  const auto step = [t](float d) { return d == 0 ? 0 : d * t; };
  const Vec3 from = ray.origin - origin;
  const Vec3 way{step(ray.direction.x), step(ray.direction.y), step(ray.direction.z)};
  return {from + way, gamma(16) * (sum_of_sizes(from) + sum_of_sizes(way)) + kFrustumTiny};
}

/// The slopes of the hull of the rays' lines over the box's extent on the axis. Any finite value is
/// correct.
RAYSHEAF_HD inline void choose_slopes(View<const Ray> rays, int side, int plane, PacketFrustum* f) {
  const float first = f->low[f->axis], last = f->high[f->axis];
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float low[2] = {kInfinity, kInfinity}, high[2] = {-kInfinity, -kInfinity};
  for (const Ray& ray : rays) {
    const Vec3 from = ray.origin - f->origin;
    const float slope = component(ray.direction, side) / component(ray.direction, f->axis);
    for (int e = 0; e < 2; ++e) {
      const float a = (e == 0 ? first : last) - component(from, f->axis);
      const float u = component(from, side) + slope * a;
      low[e] = std::fmin(low[e], u);
      high[e] = std::fmax(high[e], u);
    }
  }
  const auto finite_or_zero = [](float slope) { return std::fabs(slope) < 16 ? slope : 0; };
  f->upper_slope[plane] = finite_or_zero((high[1] - high[0]) / (last - first));
  f->lower_slope[plane] = finite_or_zero((low[1] - low[0]) / (last - first));
}

/// Sets ends[2 i] and ends[2 i + 1] to the ends of ray i, and the box to the bounds of all. Returns
/// false if the box would not be finite.
RAYSHEAF_HD inline bool measure_box(View<const Ray> rays, const Box& scene, View<RayEnd> ends,
                                    PacketFrustum* f) {
  Box box;
  float worst = 0;
  for (std::size_t i = 0; i < rays.size; ++i) {
    const RayPart part = part_in_scene(rays[i], scene);
    ends[2 * i] = ray_end(rays[i], f->origin, part.begin);
    ends[2 * i + 1] = ray_end(rays[i], f->origin, part.end);
    f->spread = std::fmax(f->spread, sum_of_sizes(rays[i].origin - f->origin));
  }
  for (const RayEnd& end : ends) {
    const Vec3 slack{end.slack, end.slack, end.slack};
    box.min = min(box.min, end.at - slack);
    box.max = max(box.max, end.at + slack);
    worst = end.slack < worst ? worst : end.slack;
  }
  for (int k = 0; k < 3; ++k) {
    f->low[k] = component(box.min, k);
    f->high[k] = component(box.max, k);
  }
  return worst < kFrustumHuge;
}

/// The offsets of one axis's planes, for known slopes.
RAYSHEAF_HD inline void measure_planes(View<const RayEnd> ends, int side, int plane,
                                       PacketFrustum* f) {
  const float m = f->upper_slope[plane], n = f->lower_slope[plane];
  float upper = f->upper_offset[plane], lower = f->lower_offset[plane];
  for (const RayEnd& end : ends) {
    const float u = component(end.at, side), a = component(end.at, f->axis);
    upper = std::fmax(upper, (u - m * a) + end.slack * (1 + std::fabs(m)));
    lower = std::fmin(lower, (u - n * a) - end.slack * (1 + std::fabs(n)));
  }
  f->upper_offset[plane] = upper;
  f->lower_offset[plane] = lower;
  f->lean = std::fmax(f->lean, 1 + std::fmax(std::fabs(m), std::fabs(n)));
}

/// Bounds at least one ray; `axis` should be the dominant axis of all. `ends` needs room for two
/// per ray. O(rays).
RAYSHEAF_HD inline PacketFrustum bound_packet(View<const Ray> rays, int axis, const Box& scene,
                                              View<RayEnd> ends) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  PacketFrustum f{};
  f.origin = rays[0].origin;
  f.axis = axis;
  f.lean = 1;
  if (!measure_box(rays, scene, ends, &f)) {
    for (int k = 0; k < 3; ++k) f.low[k] = -kInfinity, f.high[k] = kInfinity;
    for (int plane = 0; plane < 2; ++plane)
      f.lower_offset[plane] = -kInfinity, f.upper_offset[plane] = kInfinity;
    return f;
  }
  for (int plane = 0; plane < 2; ++plane) {
    const int side = (axis + 1 + plane) % 3;
    f.lower_offset[plane] = kInfinity;
    f.upper_offset[plane] = -kInfinity;
    choose_slopes(rays, side, plane, &f);
    measure_planes({ends.data, ends.size}, side, plane, &f);
  }
  return f;
}

/// Whether the packet may hit a triangle in the box. Comparisons with NaN accept.
RAYSHEAF_HD inline bool meets(const PacketFrustum& f, Vec3 box_min, Vec3 box_max) {
  const Vec3 low = box_min - f.origin, high = box_max - f.origin;
  const float size = sum_of_sizes(max(abs(low), abs(high))) + f.spread;
  const float slack = kFrustumSlack * size + kFrustumTiny;
  for (int k = 0; k < 3; ++k) {
    if (component(low, k) > f.high[k] + slack) return false;
    if (component(high, k) < f.low[k] - slack) return false;
  }
  const float a_low = component(low, f.axis), a_high = component(high, f.axis);
  for (int plane = 0; plane < 2; ++plane) {
    const int side = (f.axis + 1 + plane) % 3;
    const float m = f.upper_slope[plane], n = f.lower_slope[plane];
    const float least = component(low, side) - (m > 0 ? m * a_high : m * a_low);
    const float most = component(high, side) - (n > 0 ? n * a_low : n * a_high);
    if (least > f.upper_offset[plane] + slack * f.lean) return false;
    if (most < f.lower_offset[plane] - slack * f.lean) return false;
  }
  return true;
}

/// The same for a triangle, given by its corners.
RAYSHEAF_HD inline bool meets(const PacketFrustum& f, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 low = min(min(a, b), c) - f.origin, high = max(max(a, b), c) - f.origin;
  const float size = sum_of_sizes(max(abs(low), abs(high))) + f.spread;
  const float slack = kFrustumSlack * size + kFrustumTiny;
  for (int k = 0; k < 3; ++k) {
    if (component(low, k) > f.high[k] + slack) return false;
    if (component(high, k) < f.low[k] - slack) return false;
  }
  const Vec3 corner[3] = {a - f.origin, b - f.origin, c - f.origin};
  for (int plane = 0; plane < 2; ++plane) {
    const int side = (f.axis + 1 + plane) % 3;
    const float m = f.upper_slope[plane], n = f.lower_slope[plane];
    const float reach = slack * f.lean;
    bool above = true, below = true;
    for (const Vec3& p : corner) {
      const float u = component(p, side), along = component(p, f.axis);
      if (!(u - m * along > f.upper_offset[plane] + reach)) above = false;
      if (!(u - n * along < f.lower_offset[plane] - reach)) below = false;
    }
    if (above || below) return false;
  }
  return true;
}

}  // namespace raysheaf
