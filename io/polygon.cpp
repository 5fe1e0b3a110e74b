#include "io/polygon.h"

#include <algorithm>
#include <cmath>

#include "io/linear.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

struct Point {
  double x = 0, y = 0;
  bool operator==(const Point&) const = default;
};

/// Twice the signed area of a, b, c; positive if they turn left.
double turn(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Projects the polygon onto the plane of its normal (by Newell's method: a sum over the edges) so
/// that it turns left; empty if it has no area.
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

/// Ear clipping (Meisters 1975): cuts off corners whose triangle contains no other part of the
/// polygon. The polygon may touch itself, as with holes that are connected to the border by a pair
/// of coincident edges. If there is no ear, the polygon crosses itself, and any corner is cut.
class EarClipper {
 public:
  explicit EarClipper(const std::vector<Point>& points)
      : points_(points),
        next_(points.size()),
        previous_(points.size()),
        work_left_(kWorkPerCorner * points.size()) {
    const auto n = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    for (std::uint32_t i = 0; i < n; ++i)
      if (!(turn_at(i) > 0)) blunt_.push_back(i);
    std::sort(blunt_.begin(), blunt_.end(),
              [&points](std::uint32_t i, std::uint32_t j) { return points[i].x < points[j].x; });
  }

  Triangles clip() {
    Triangles result;
    std::uint32_t at = 0;
    for (std::size_t left = points_.size(); left > 3; --left) {
      at = corner_to_cut(at, left);
      const std::uint32_t before = previous_[at], after = next_[at];
      result.push_back({before, at, after});
      next_[before] = after;
      previous_[after] = before;
      next_[at] = kInvalidId;  // removed
      at = after;
    }
    result.push_back({previous_[at], at, next_[at]});
    return result;
  }

 private:
  /// The limit of tests per corner, on average. Even noisy radii or thousands of teeth need less
  /// than half of it.
  static constexpr std::size_t kWorkPerCorner = 4096;

  [[nodiscard]] double turn_at(std::uint32_t i) const {
    return turn(points_[previous_[i]], points_[i], points_[next_[i]]);
  }

  /// The first ear from `at` on; without an ear, a flat corner, then any that turns left.
  std::uint32_t corner_to_cut(std::uint32_t at, std::size_t left) {
    std::uint32_t flat = kInvalidId, left_turn = kInvalidId;
    for (std::uint32_t i = at; left > 0 && work_left_ > 0; i = next_[i], --left) {
      spend();
      const double turned = turn_at(i);
      if (turned > 0 && is_ear(i)) return i;
      if (turned == 0 && flat == kInvalidId) flat = i;
      if (turned > 0 && left_turn == kInvalidId) left_turn = i;
    }
    return flat != kInvalidId ? flat : left_turn != kInvalidId ? left_turn : at;
  }

  /// Whether no part of the polygon reaches into the triangle of a corner that turns left. If any
  /// part does, so does a corner that does not turn left: only those are tested.
  bool is_ear(std::uint32_t i) {
    const Point a = points_[previous_[i]], b = points_[i], c = points_[next_[i]];
    const double least_x = std::min({a.x, b.x, c.x}), greatest_x = std::max({a.x, b.x, c.x});
    const double least_y = std::min({a.y, b.y, c.y}), greatest_y = std::max({a.y, b.y, c.y});
    forget_those_gone();
    auto q = std::lower_bound(blunt_.begin(), blunt_.end(), least_x,
                              [this](std::uint32_t j, double x) { return points_[j].x < x; });
    for (; q != blunt_.end() && points_[*q].x <= greatest_x; ++q) {
      spend();
      const double y = points_[*q].y;
      if (y < least_y || y > greatest_y || *q == previous_[i] || *q == next_[i]) continue;
      if (next_[*q] != kInvalidId && reaches_into(*q, a, b, c)) return false;
    }
    return true;
  }

  /// Whether corner q lies in the triangle or on its border. If it coincides with one of the
  /// triangle's corners: whether an edge leads inside from it.
  [[nodiscard]] bool reaches_into(std::uint32_t q, Point a, Point b, Point c) const {
    const Point p = points_[q];
    if (p == a || p == b || p == c)
      return lies_towards(points_[next_[q]], p, a, b, c) ||
             lies_towards(points_[previous_[q]], p, a, b, c);
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
  }

  /// Whether `to`, seen from `corner` of the triangle, lies between its other two corners.
  [[nodiscard]] static bool lies_towards(Point to, Point corner, Point a, Point b, Point c) {
    const bool of_ab = turn(a, b, to) > 0, of_bc = turn(b, c, to) > 0, of_ca = turn(c, a, to) > 0;
    return corner == a ? of_ca && of_ab : corner == b ? of_ab && of_bc : of_bc && of_ca;
  }

  /// Removes corners that were cut or turn left by now. Runs rarely enough that its cost is
  /// negligible.
  void forget_those_gone() {
    if (++tests_since_ < blunt_.size()) return;
    std::erase_if(blunt_,
                  [this](std::uint32_t j) { return next_[j] == kInvalidId || turn_at(j) > 0; });
    tests_since_ = 0;
  }

  void spend() { work_left_ -= work_left_ > 0 ? 1 : 0; }

  const std::vector<Point>& points_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<std::uint32_t> blunt_;  ///< corners that did not turn left, sorted by x
  std::size_t tests_since_ = 0, work_left_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Vec3>& points) {
  if (points.size() < 3) return {};
  if (points.size() == 3) return fan(points.size());
  const std::vector<Point> flat = flatten(points);
  return flat.empty() || is_convex(flat) ? fan(points.size()) : EarClipper(flat).clip();
}

void warn_of_odd_faces(std::uint64_t count, bool any_left, std::vector<std::string>& warnings) {
  if (count == 0) return;
  if (!any_left) refuse("every face has a vertex that is not finite");
  warnings.push_back(count == 1
                         ? "A face is left out: it has a vertex that is not finite."
                         : std::to_string(count) +
                               " faces are left out: they have vertices that are not finite.");
}

}  // namespace raysheaf::io
