// Validation of a ray.
#pragma once

#include <cmath>

#include "base/vec.h"

namespace raysheaf {

/// Whether the ray is valid: finite, with a direction, 0 <= t_min <= t_max.
RAYSHEAF_HD inline bool is_right(const Ray& ray) {
  const Vec3 d = ray.direction;
  return is_finite(ray.origin) && is_finite(d) && !(d.x == 0 && d.y == 0 && d.z == 0) &&
         ray.t_min >= 0 && ray.t_min <= ray.t_max;
}

struct RayFault {
  const char* field = nullptr;  ///< null: the ray is valid
  const char* sentence = nullptr;
};

inline RayFault fault_of(const Ray& ray) {
  if (!is_finite(ray.origin)) return {"origin", "the origin is not finite"};
  if (!is_finite(ray.direction)) return {"direction", "the direction is not finite"};
  if (ray.direction.x == 0 && ray.direction.y == 0 && ray.direction.z == 0)
    return {"direction", "the direction is zero"};
  if (std::isnan(ray.t_min)) return {"t_min", "t_min is not a number"};
  if (std::isnan(ray.t_max)) return {"t_max", "t_max is not a number"};
  if (ray.t_min < 0) return {"t_min", "t_min is negative"};
  if (ray.t_min > ray.t_max) return {"t_min", "t_min is larger than t_max"};
  return {};
}

}  // namespace raysheaf
