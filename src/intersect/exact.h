// Determinants in exact arithmetic on the given floats, on which `exact_answer` is based.
//
// With a, b, c the corners relative to the ray's origin and d its direction, all answers are signs
// and quotients of determinants of third degree:
//
//    [d, b, c]  [d, c, a]  [d, a, b]     edge functions: the weights of the corners, times det
//    det = their sum = [d, b - a, c - a]
//    t = [a, b, c] / det,   u = [d, c, a] / det,   v = [d, a, b] / det
//
// Each is first computed in binary64 with an error bound. If that does not decide, it is computed
// by expansions (J. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust
// Geometric Predicates", 1997): sums of binary64 numbers that represent the value exactly. Neither
// overflows or underflows: a product of three coordinates, or of three differences of coordinates,
// is a multiple of 2^-447 and below 2^387, and so are all rounding errors.
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

/// With the correct sign and a relative error of at most 2^-40.
[[nodiscard]] double determinant(const Rows& rows);
/// Only its sign: -1, 0 or 1.
[[nodiscard]] int sign_of_determinant(const Rows& rows);

/// Whether `exact_answer` has `meets` and a `t` that is not negative. Faster, because it needs only
/// signs.
[[nodiscard]] bool meets_exactly(const Ray& ray, Vec3 a, Vec3 b, Vec3 c);

}  // namespace raysheaf::checks
