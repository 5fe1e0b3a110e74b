#include "lab/verify/point_judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "intersect/exact.h"

namespace raysheaf::checks {
namespace {

/// A number of 113 bits: GCC's and Clang's, or `long double` where that has as many, as on aarch64.
#ifdef __SIZEOF_FLOAT128__
__extension__ using Wide = __float128;
#else
using Wide = long double;
static_assert(std::numeric_limits<Wide>::digits == 113);
#endif

struct WidePoint {
  Wide x, y, z;
};
WidePoint to_wide(Point p) {
  return {p.x, p.y, p.z};
}
WidePoint operator-(WidePoint a, WidePoint b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
WidePoint moved(WidePoint a, Wide s, WidePoint b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
Wide wide_dot(WidePoint a, WidePoint b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
WidePoint wide_cross(WidePoint a, WidePoint b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Wide wide_to_edge(WidePoint p, WidePoint a, WidePoint b) {
  const WidePoint h = b - a;
  const Wide length = wide_dot(h, h);
  Wide t = length > 0 ? wide_dot(p - a, h) / length : Wide{0};
  t = t < 0 ? Wide{0} : t > 1 ? Wide{1} : t;
  const WidePoint r = p - moved(a, t, h);
  return wide_dot(r, r);
}

/// By the plane where the foot of the perpendicular is inside, which three signs say.
Wide wide_square(WidePoint p, WidePoint a, WidePoint b, WidePoint c) {
  const WidePoint n = wide_cross(b - a, c - a);
  const Wide nn = wide_dot(n, n);
  const auto inside = [&](WidePoint s, WidePoint t) {
    return wide_dot(wide_cross(t - s, p - s), n) >= 0;
  };
  if (nn > 0 && inside(a, b) && inside(b, c) && inside(c, a)) {
    const Wide height = wide_dot(p - a, n);
    return height * height / nn;
  }
  return std::min({wide_to_edge(p, a, b), wide_to_edge(p, b, c), wide_to_edge(p, c, a)});
}

/// Calls `take(mesh, triangle, corners)` for the meshes that are seen.
template <class Take>
void for_each_triangle(const Soup& soup, std::span<const std::uint8_t> seen, const Take& take) {
  for (std::uint32_t mesh = 0; mesh < soup.meshes.size(); ++mesh)
    for (std::uint32_t i = 0; seen[mesh] != 0 && 3 * i < soup.meshes[mesh].size(); ++i)
      take(mesh, i, &soup.meshes[mesh][std::size_t{3} * i]);
}

std::string numbers(const char* format, double a, double b) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

}  // namespace

double wide_distance(Point point, Point a, Point b, Point c) {
  // 113 bits have a root of 53: the squares are within the range of doubles.
  return std::sqrt(
      static_cast<double>(wide_square(to_wide(point), to_wide(a), to_wide(b), to_wide(c))));
}

double longest_edge(Point a, Point b, Point c) {
  return std::sqrt(std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)}));
}

std::string fault_of(Point point, const ClosestPoint& found, const Soup& soup,
                     std::span<const std::uint8_t> seen) {
  std::string fault;
  // The error that raysheaf/points.h allows, and that of the square root here.
  const auto slack = [](double distance, const Vec3* p) {
    return 0x1.1p-48 * (distance + longest_edge(to_point(p[0]), to_point(p[1]), to_point(p[2])));
  };
  for_each_triangle(soup, seen, [&](std::uint32_t mesh, std::uint32_t i, const Vec3* p) {
    const double distance = wide_distance(point, to_point(p[0]), to_point(p[1]), to_point(p[2]));
    const double error = found.distance - distance;
    if (error > slack(distance, p))
      fault = numbers("a triangle is at %.17g, nearer than %.17g", distance, found.distance);
    if (mesh != found.geom_id || i != found.prim_id) return;
    if (-error > slack(distance, p))
      fault = numbers("the distance is %.17g, not %.17g", distance, found.distance);
    const Vec3 at{static_cast<float>(point.x), static_cast<float>(point.y),
                  static_cast<float>(point.z)};
    if (at.x != point.x || at.y != point.y || at.z != point.z) return;
    const int side = -sign_of_determinant({Row{p[0], at}, Row{p[1], at}, Row{p[2], at}});
    if (side != found.side) fault = numbers("the side is %g, not %g", side, found.side);
  });
  return fault;
}

std::optional<bool> inside_exactly(Vec3 point, const Soup& soup, std::span<const std::uint8_t> seen,
                                   InsideRule rule) {
  int winding = 0, odd = 0;
  bool is_clear = true;
  for (int ray = 0; ray < 6; ++ray) {
    const float way = ray < 3 ? 1.0f : -1.0f;
    const Row d{{ray % 3 == 0 ? way : 0, ray % 3 == 1 ? way : 0, ray % 3 == 2 ? way : 0}, {}};
    int crossings = 0;
    for_each_triangle(soup, seen, [&](std::uint32_t /*mesh*/, std::uint32_t /*i*/, const Vec3* p) {
      const Row a{p[0], point}, b{p[1], point}, c{p[2], point};
      const int weights[] = {sign_of_determinant({d, b, c}), sign_of_determinant({d, c, a}),
                             sign_of_determinant({d, a, b})};
      const auto [least, most] = std::minmax_element(weights, weights + 3);
      if (*least < 0 && *most > 0) return;  // the line misses it
      // t has the sign of [a, b, c] / det, and det that of the weights.
      const int volume = sign_of_determinant({a, b, c});
      if (*least == 0 || *most == 0 || volume == 0) {
        is_clear = false;
        return;
      }
      if (volume != *most) return;  // behind the point
      winding += *most;
      ++crossings;
    });
    odd += crossings % 2;
  }
  if (!is_clear) return {};
  return 2 * (rule == InsideRule::kNonZero ? std::abs(winding) : odd) > 6;
}

}  // namespace raysheaf::checks
