#include "io/polygon.h"

#include <numeric>

#include "io/linear.h"

namespace raysheaf::io {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

struct Point {
  double x = 0, y = 0;
};

/// Twice the signed area of a, b, c; positive where they turn to the left.
double turn(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon seen against its normal (Newell's: the sum over the edges), so that it goes round to
/// the left; empty where it has no area.
std::vector<Point> flatten(const std::vector<Vec3>& points) {
  const Double3 origin = widen(points[0]);
  Double3 normal;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    normal = normal + cross(widen(points[i]) - origin, widen(points[i + 1]) - origin);
  }
  const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
  if (!(x + y + z > 0) || !std::isfinite(x + y + z)) return {};
  std::vector<Point> flat;
  for (const Vec3& p : points) {
    const Double3 d = widen(p) - origin;
    if (x >= y && x >= z)
      flat.push_back(normal.x > 0 ? Point{d.y, d.z} : Point{d.z, d.y});
    else if (y >= z)
      flat.push_back(normal.y > 0 ? Point{d.z, d.x} : Point{d.x, d.z});
    else
      flat.push_back(normal.z > 0 ? Point{d.x, d.y} : Point{d.y, d.x});
  }
  return flat;
}

bool is_convex(const std::vector<Point>& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (turn(p[i], p[(i + 1) % p.size()], p[(i + 2) % p.size()]) < 0) return false;
  }
  return true;
}

Triangles fan(std::size_t corners) {
  Triangles result;
  for (std::uint32_t i = 1; i + 1 < corners; ++i) result.push_back({0, i, i + 1});
  return result;
}

/// Whether the corner `ring[i]` can be cut off: it turns to the left and no other corner is inside.
bool is_ear(const std::vector<Point>& p, const std::vector<std::uint32_t>& ring, std::size_t i) {
  const std::size_t n = ring.size();
  const Point a = p[ring[(i + n - 1) % n]], b = p[ring[i]], c = p[ring[(i + 1) % n]];
  if (!(turn(a, b, c) > 0)) return false;
  for (std::size_t k = 2; k + 1 < n; ++k) {
    const Point q = p[ring[(i + k) % n]];
    if (turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0) return false;
  }
  return true;
}

/// Corners that are looked at for each that is cut, on average; polygons of files need two or
/// three.
constexpr std::size_t kTestsPerCorner = 8;

/// Cuts ears (Meisters 1975). Where there is none, the polygon crosses itself: then any corner.
Triangles clip_ears(const std::vector<Point>& p) {
  std::vector<std::uint32_t> ring(p.size());
  std::iota(ring.begin(), ring.end(), 0u);
  Triangles result;
  std::size_t start = 0, tests = kTestsPerCorner * p.size();
  while (ring.size() > 3) {
    const std::size_t n = ring.size();
    std::size_t i = start % n;
    for (std::size_t tried = 0; tried < n && tests > 0 && !is_ear(p, ring, i); ++tried, --tests) {
      i = (i + 1) % n;
    }
    result.push_back({ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
    start = i;
  }
  result.push_back({ring[0], ring[1], ring[2]});
  return result;
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Vec3>& points) {
  if (points.size() < 3) return {};
  if (points.size() == 3 || points.size() > kMaxEarCorners) return fan(points.size());
  const std::vector<Point> flat = flatten(points);
  return flat.empty() || is_convex(flat) ? fan(points.size()) : clip_ears(flat);
}

}  // namespace raysheaf::io
