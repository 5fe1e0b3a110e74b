// Stage 1 of the ray-triangle test by itself, for one ray and one triangle; devices use it during
// traversal.
#pragma once

#include "intersect/triangle_body.h"

namespace raysheaf {

/// The result of binary32 for a ray and a triangle: the rounded t of a hit is in [low, high].
struct FloatAnswer {
  enum Kind : std::uint8_t { kMiss, kHit, kUnsure } kind = kMiss;
  bool front = false;
  float low = 0, high = 0;
};

/// Stage 1 with the interval of t. Only a hit whose whole interval is within [t_min, t_max] is
/// certain; hits may reduce t_max.
RAYSHEAF_HD inline FloatAnswer answer_in_floats(const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c) {
  const Edges e = edges_of(ray, a, b, c);
  FloatAnswer answer;
  if (e.surely_miss()) return answer;
  const float det = (e.u + e.v) + e.w, size = std::fabs(det), per_det = 1 / det;
  const float distance =
      (e.u * (ray.shear_z * e.az) + e.v * (ray.shear_z * e.bz)) + e.w * (ray.shear_z * e.cz);
  const float t = distance * per_det, far = std::fabs(distance);
  const float of_weights = (kErrorOfWeights * (e.error * e.reach)) * std::fabs(per_det);
  const float half = std::fabs(ray.shear_z) * (of_weights + kErrorOfDepth * e.size);
  answer.low = t - half;
  answer.high = t + half;
  answer.front = det > 0;
  const bool normal = size >= kSmallDeterminant && size <= kLargeDeterminant &&
                      far >= kSmallDistance && far <= kLargeDeterminant && half >= kSmallInterval;
  const bool sure = e.surely_hit() && normal;
  if (sure && answer.low >= ray.t_min && answer.high <= ray.t_max) {
    answer.kind = FloatAnswer::kHit;
  } else if (!(sure && (answer.high < ray.t_min || answer.low > ray.t_max))) {
    answer.kind = FloatAnswer::kUnsure;
  }
  return answer;
}

}  // namespace raysheaf
