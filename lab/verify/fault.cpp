#include "lab/verify/fault.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "lab/verify/round.h"

namespace raysheaf::checks {
namespace {

std::string numbers(const char* what, double t, double u, double v, bool front) {
  char text[200];
  std::snprintf(text, sizeof text, "%s at t %.9g, u %.9g, v %.9g of the %s", what, t, u, v,
                front ? "front" : "back");
  return text;
}

bool is_weight(float reported, double exact) {
  return reported >= 0 && reported <= 1 &&
         std::fabs(double{reported} - exact) <= kMostErrorOfWeights;
}

/// For a correctly reported hit.
std::string what_is_wrong(const ExactAnswer& exact, const TriangleHit& hit) {
  if (const double error = error_in_ulps(hit.t, exact.t); !(error <= kMostUlpsOfT)) {
    char text[80];
    std::snprintf(text, sizeof text, "t is wrong by %.3g ulp", error);
    return text;
  }
  if (std::signbit(hit.t)) return "t is -0 or less";
  if (!is_weight(hit.u, exact.u)) return "u is wrong";
  if (!is_weight(hit.v, exact.v)) return "v is wrong";
  return hit.front == exact.front ? "" : "the side is wrong";
}

}  // namespace

double error_in_ulps(float reported, double exact) {
  const float near = std::fabs(static_cast<float>(exact));
  const float next = std::nextafter(near, std::numeric_limits<float>::infinity());
  const double spacing = std::isfinite(next) ? double{next} - double{near} : 0x1p104;
  return std::fabs(double{reported} - exact) / spacing;
}

bool is_hit(const ExactAnswer& exact) {
  return exact.meets && exact.t >= 0 && std::isfinite(static_cast<float>(exact.t));
}

std::string text_of(const Ray& ray, const std::array<Vec3, 3>& corners) {
  return text_of(ray) + ", triangle " + text_of(corners[0]) + ", " + text_of(corners[1]) + ", " +
         text_of(corners[2]);
}

std::string fault_of(const Ray& ray, const std::array<Vec3, 3>& corners, const ExactAnswer& exact,
                     bool met, const TriangleHit& hit) {
  const bool expected = is_hit(exact);
  if (!met && !expected) return {};
  // A reported t with an error of 2 ulp may be infinite although the exact one is finite, and
  // conversely.
  const double largest = std::numeric_limits<float>::max();
  if (met != expected && exact.meets && std::fabs(exact.t - largest) <= largest * 0x1p-22)
    return {};
  std::string what = met ? expected ? what_is_wrong(exact, hit) : "a false hit" : "a missed hit";
  if (what.empty()) return {};
  const std::string right =
      numbers(expected ? "a hit" : "a miss, with the line", exact.t, exact.u, exact.v, exact.front);
  const std::string got = met ? numbers("a hit", hit.t, hit.u, hit.v, hit.front) : "a miss";
  return what + ": " + text_of(ray, corners) + ": expected " + right + ", got " + got;
}

}  // namespace raysheaf::checks
