// The part of a scene that cameras and lights must show.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/vec.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// A sphere around the scene's box. A scene without extent gets a small one, so that planes and
/// distances stay distinct.
struct Subject {
  Vec3 center{0, 0, 0};
  float radius = 1;
};

inline Subject subject_of(const Box& box) {
  constexpr double kLargest = 1e18;
  Subject subject;
  double half_squared = 0, farthest = 0;
  float* const center[3] = {&subject.center.x, &subject.center.y, &subject.center.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = component(box.min, axis), high = component(box.max, axis);
    if (!(low >= -kLargest && low <= high && high <= kLargest)) return {};
    *center[axis] = static_cast<float>((low + high) / 2);
    half_squared += (high - low) * (high - low) / 4;
    farthest = std::max({farthest, std::fabs(low), std::fabs(high)});
  }
  // At least eight float32 spacings: with fewer, the camera's position would not resolve the scene.
  constexpr double kLeastExtent = 1e-6;
  const double radius = std::max(std::sqrt(half_squared), kLeastExtent * farthest);
  if (radius > 0) subject.radius = static_cast<float>(radius);
  return subject;
}

inline std::array<Vec3, 8> corners_of(const Box& box) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                  (i & 4) != 0 ? box.max.z : box.min.z};
  }
  return corners;
}

/// Finds how much of a camera's image some points span.
class Sighting {
 public:
  explicit Sighting(const Camera& camera);
  /// In world space.
  void add(Vec3 point);
  /// The visible part of an edge between two added points.
  void add_edge(Vec3 from, Vec3 to);
  /// Whether some points are in front of the eye and others are not, so that edges matter.
  [[nodiscard]] bool is_cut() const { return is_behind_ && left_ <= right_; }
  /// `shows`, for the points so far.
  [[nodiscard]] bool suffices() const;

 private:
  std::array<double, 3> eye_;
  std::array<std::array<double, 3>, 3> axes_;  ///< right and up, in halves of the image, and back
  bool orthographic_, is_behind_ = false;      ///< a point is not in front of the eye
  void add_in_front(const std::array<double, 3>& p, double depth);

  /// The box in the image around the points in front of the eye.
  double left_ = std::numeric_limits<double>::infinity(), right_ = -left_, low_ = left_,
         top_ = right_;
};

/// The position along an axis, a unit vector that is parallel to an edge of the box, of the box's
/// lowest points.
inline float lowest_along(const Box& box, Vec3 up) {
  for (int axis = 0; axis < 3; ++axis) {
    if (component(up, axis) > 0) return component(box.min, axis);
    if (component(up, axis) < 0) return -component(box.max, axis);
  }
  return 0;
}

}  // namespace raysheaf
