// What a ray and a triangle have to do with each other, in exact arithmetic on the floats as given.
//
// With a, b, c the corners as seen from the ray's origin and d its direction, all answers are signs
// and quotients of determinants of third degree:
//
//    [d, b, c]  [d, c, a]  [d, a, b]     edge functions: the weights of the corners, times det
//    det = their sum = [d, b - a, c - a]
//    t = [a, b, c] / det,   u = [d, c, a] / det,   v = [d, a, b] / det
//
// Each is first computed in the widest type that there is with a bound of its error, and where that
// does not settle sign and 40 bits, by expansions (J. Shewchuk, "Adaptive Precision Floating-Point
// Arithmetic and Fast Robust Geometric Predicates", 1997): sums of binary64 numbers that hold the
// value exactly. Floats are so short that nothing underflows: products of three are at least
// 2^-447.
#pragma once

#include <array>

#include "base/vec.h"

namespace raysheaf::checks {

struct ExactAnswer {
  /// Whether the line through the ray meets the closed triangle in one point; its plane is then not
  /// parallel to the ray. The interval of the ray is not looked at.
  bool meets = false;
  /// To within 2^-38 relative, with the right signs; 0 where the plane is parallel to the ray.
  double t = 0, u = 0, v = 0;
};

[[nodiscard]] ExactAnswer exact_answer(const Ray& ray, Vec3 a, Vec3 b, Vec3 c);

/// A row of a determinant: from one point to another.
struct Row {
  Vec3 to, from;
};
using Rows = std::array<Row, 3>;

/// With the right sign, and to within 2^-40 relative.
[[nodiscard]] double determinant(const Rows& rows);

}  // namespace raysheaf::checks
