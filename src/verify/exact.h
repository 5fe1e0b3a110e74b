// Determinants in exact arithmetic on the floats as given, which `exact_answer` stands on.
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
#include "raysheaf/exact.h"

namespace raysheaf::checks {

/// A row of a determinant: from one point to another.
struct Row {
  Vec3 to, from;
};
using Rows = std::array<Row, 3>;

/// With the right sign, and to within 2^-40 relative.
[[nodiscard]] double determinant(const Rows& rows);

}  // namespace raysheaf::checks
