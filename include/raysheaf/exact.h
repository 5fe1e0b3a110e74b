// Whether and where a ray intersects a triangle, in exact arithmetic on the given floats. Every
// query must agree with this answer.
#pragma once

#include "raysheaf/query.h"

namespace raysheaf {

struct ExactAnswer {
  /// Whether the line through the ray intersects the closed triangle (edges and corners included)
  /// in one point. False if the line is parallel to the triangle's plane, and for triangles without
  /// area.
  bool meets = false;
  /// Whether the line comes from the side from which the corners are counter-clockwise.
  bool front = false;
  /// Where the line intersects the plane, with a relative error of at most 2^-38 and correct signs;
  /// 0 if it is parallel to the plane.
  double t = 0, u = 0, v = 0;
};

/// Computes the exact answer. A query reports a hit if `meets` is true, t >= 0, and t rounded to
/// float lies in the ray's interval [t_min, t_max], ends included. (A negative t that rounds to -0
/// is a miss.) The t that a query reports and compares with the interval and with other hits
/// differs from the exact one by at most 2 ulp; therefore the reported t decides if t is that near
/// to an end of the interval.
///
/// The floats must be finite. Takes 0.1 to 0.5 microseconds (J. Shewchuk, "Adaptive Precision
/// Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997).
[[nodiscard]] ExactAnswer exact_answer(const Ray& ray, Vec3 a, Vec3 b, Vec3 c);

}  // namespace raysheaf
