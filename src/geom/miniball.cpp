#include "geom/miniball.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geom/rounding.h"

namespace raysheaf {
namespace {

using Point = std::array<double, 3>;

Point to_point(Vec3 v) {
  return {v.x, v.y, v.z};
}
Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point plus(const Point& a, const Point& b, double s) {
  return {a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s};
}
double inner(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double squared_distance(const Point& a, const Point& b) {
  const Point d = minus(a, b);
  return inner(d, d);
}

/// The smallest sphere with up to four given points on its boundary and with its centre in their
/// affine hull.
///
/// A point p outside is added by moving the centre c along d, the part of p - q0 that is orthogonal
/// to the hull: all points of the boundary stay equally far, and |p - c - f d|^2 = r^2 + f^2 |d|^2
/// gives f = e / (2 |d|^2), where e = |p - c|^2 - r^2; r^2 grows by e f / 2 (section 3 of the
/// paper).
class Boundary {
 public:
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] const Point& center() const { return states_[size_].center; }
  [[nodiscard]] double squared_radius() const { return states_[size_].squared_radius; }
  [[nodiscard]] double excess(const Point& p) const {
    return squared_distance(p, center()) - squared_radius();
  }

  /// Returns false and changes nothing if `p` is so close to the hull that rounding errors would
  /// determine the direction.
  bool push(const Point& p) {
    State& next = states_[size_ + 1];
    if (size_ == 0) {
      origin_ = p;
      next = {p, 0};
    } else {
      Point d = minus(p, origin_);
      for (int i = 1; i < size_; ++i) {
        d = plus(d, directions_[i],
                 -inner(d, directions_[i]) / inner(directions_[i], directions_[i]));
      }
      constexpr double kFlat = 1e-30;
      const double dd = inner(d, d);
      if (!(dd > kFlat * std::max(squared_radius(), squared_distance(p, origin_)))) return false;
      const double e = excess(p), f = e / (2 * dd);
      directions_[size_] = d;
      next = {plus(center(), d, f), squared_radius() + e * f / 2};
    }
    ++size_;
    return true;
  }
  void pop() { --size_; }

 private:
  struct State {
    Point center{};
    double squared_radius = -1;
  };
  int size_ = 0;
  Point origin_{};
  std::array<Point, 4> directions_;  ///< orthogonal; the first is not used
  std::array<State, 5> states_;
};

/// The smallest sphere of a few points: the support of the current sphere, and the farthest of all
/// points.
///
/// The paper keeps all points in one list. Between two pivots its move to front only reads the
/// support, which precedes all other points; this list holds only that part.
class SupportSolver {
 public:
  [[nodiscard]] const Point& center() const { return center_; }
  [[nodiscard]] double squared_radius() const { return squared_radius_; }

  /// The smallest sphere of the support and `p`, with `p` on its boundary (`pivot_mb` of the
  /// paper).
  void add(const Point& p) {
    boundary_ = {};
    boundary_.push(p);
    record();
    const int count = support_;
    support_ = 0;
    move_to_front(count);
    std::copy_backward(points_.begin(), points_.begin() + support_, points_.begin() + support_ + 1);
    points_[0] = p;
    ++support_;
  }

 private:
  /// The smallest sphere of the first `count` points that has the points of the boundary on its
  /// surface (`mtf_mb` of the paper).
  void move_to_front(int count) {
    support_ = 0;
    if (boundary_.size() == 4) return;
    for (int k = 0; k < count; ++k) {
      const Point p = points_[k];
      if (!(excess(p) > 0) || !boundary_.push(p)) continue;
      record();
      move_to_front(k);
      boundary_.pop();
      std::copy_backward(points_.begin(), points_.begin() + k, points_.begin() + k + 1);
      points_[0] = p;
      ++support_;
    }
  }
  [[nodiscard]] double excess(const Point& p) const {
    return squared_distance(p, center_) - squared_radius_;
  }
  void record() {
    center_ = boundary_.center();
    squared_radius_ = boundary_.squared_radius();
  }

  Boundary boundary_;
  std::array<Point, 6> points_{};
  int support_ = 0;
  Point center_{};
  double squared_radius_ = -1;
};

struct Farthest {
  std::size_t index;
  double squared_distance;
};
Farthest farthest(View<const Vec3> points, const Point& from) {
  Farthest result{0, -1};
  for (std::size_t i = 0; i < points.size; ++i) {
    const double d = squared_distance(to_point(points[i]), from);
    if (d > result.squared_distance) result = {i, d};
  }
  return result;
}

/// Among the centres of all pivots, the one with the nearest farthest point. In exact arithmetic it
/// is the last one; with rounding errors the last pivot may make it worse.
Point best_center(View<const Vec3> points) {
  constexpr int kMostPivots = 1000;
  SupportSolver solver;
  solver.add(to_point(points[0]));
  Point best{};
  double best_reach = std::numeric_limits<double>::infinity();
  for (int pivot = 0; pivot < kMostPivots; ++pivot) {
    const Farthest far = farthest(points, solver.center());
    if (far.squared_distance < best_reach) {
      best = solver.center();
      best_reach = far.squared_distance;
    }
    const double before = solver.squared_radius();
    if (!(far.squared_distance > before)) break;
    solver.add(to_point(points[far.index]));
    if (!(solver.squared_radius() > before)) break;
  }
  return best;
}

}  // namespace

Sphere miniball(View<const Vec3> points) {
  if (points.empty()) return {};
  const Point c = best_center(points);
  const Vec3 center{rounded(c[0]), rounded(c[1]), rounded(c[2])};
  const double reach = std::sqrt(farthest(points, to_point(center)).squared_distance);
  return {center, rounded_up(reach * (1 + 0x1p-50))};
}

}  // namespace raysheaf
