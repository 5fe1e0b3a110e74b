// Whether a ray meets a triangle, and where, in exact arithmetic on the floats as given: the answer
// that every query must give.
#pragma once

#include "raysheaf/query.h"

namespace raysheaf {

struct ExactAnswer {
  /// Whether the line through the ray meets the closed triangle in one point: edges and corners
  /// belong to it. False where the line is parallel to the triangle's plane, and for triangles
  /// without area.
  bool meets = false;
  /// Whether the line comes from the side where the corners run counter-clockwise.
  bool front = false;
  /// Where the line meets the plane, to within 2^-38 relative and with the right signs; 0 where it
  /// is parallel to the plane.
  double t = 0, u = 0, v = 0;
};

/// A query reports a hit where `meets` is true, t >= 0, and t rounded to float lies in the ray's
/// interval [t_min, t_max], ends included. (A negative t that rounds to -0 is a miss.) The t that
/// it reports, and compares with the interval and with other hits, differs from the exact one by at
/// most 2 ulp; so where t is as near as that to an end of the interval, the reported t decides.
///
/// The floats must be finite. Takes 0.1 to 0.5 microseconds (J. Shewchuk,
/// "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997).
[[nodiscard]] ExactAnswer exact_answer(const Ray& ray, Vec3 a, Vec3 b, Vec3 c);

}  // namespace raysheaf
