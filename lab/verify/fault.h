// The errors of a hit compared with exact arithmetic.
#pragma once

#include <array>
#include <string>

#include "intersect/triangle_body.h"
#include "raysheaf/exact.h"

namespace raysheaf::checks {

/// The distance of a reported t from the exact one, in ulp: the spacing of floats there, at least
/// 2^-149.
[[nodiscard]] double error_in_ulps(float reported, double exact);

inline constexpr double kMostUlpsOfT = 2;
/// The largest absolute error of u and v: if the triangle is thin or seen edge-on, a small weight
/// may have no correct digit.
inline constexpr double kMostErrorOfWeights = 4 * 0x1p-24;

/// Whether a ray with the interval [0, infinity] must report a hit: `meets`, t is not negative, and
/// t rounds to a finite float.
[[nodiscard]] bool is_hit(const ExactAnswer& exact);

/// For an answer to a ray with the interval [0, infinity]: empty if it is correct, otherwise one
/// line with the ray, the triangle, the expected and the actual answer.
[[nodiscard]] std::string fault_of(const Ray& ray, const std::array<Vec3, 3>& corners,
                                   const ExactAnswer& exact, bool met, const TriangleHit& hit);

/// "ray ..., triangle ...", with nine digits, which identify a float.
[[nodiscard]] std::string text_of(const Ray& ray, const std::array<Vec3, 3>& corners);

}  // namespace raysheaf::checks
