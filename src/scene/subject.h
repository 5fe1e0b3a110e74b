// The part of a scene that cameras and lights must show.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

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

/// The corners of the six faces of a box, in order around each face.
inline std::array<std::array<Vec3, 4>, 6> faces_of(const Box& box) {
  constexpr std::size_t kFaces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                        {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
  const std::array<Vec3, 8> corners = corners_of(box);
  std::array<std::array<Vec3, 4>, 6> faces;
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t k = 0; k < 4; ++k) faces[face][k] = corners[kFaces[face][k]];
  return faces;
}

/// Finds how much of a camera's image some polygons span.
class Sighting {
 public:
  explicit Sighting(const Camera& camera);
  /// Adds what the image shows of a convex polygon in world space, which has three or four corners:
  /// the polygon is clipped to the view frustum (I. Sutherland, G. Hodgman, "Reentrant Polygon
  /// Clipping", CACM 17(1), 1974).
  void add(std::span<const Vec3> corners);
  /// `shows`, for the polygons so far.
  [[nodiscard]] bool suffices() const { return is_empty_ || spans_enough(); }
  /// The same, but false without polygons: once true, it stays true.
  [[nodiscard]] bool spans_enough() const;

 private:
  /// The image reaches from -w to w in x and y.
  struct Corner {
    double x, y, w, depth;
  };
  static constexpr std::size_t kPlanes = 6, kMostCorners = 4 + kPlanes;
  struct Polygon {
    std::array<Corner, kMostCorners> corners;
    std::size_t count = 0;
  };
  [[nodiscard]] Corner corner_of(Vec3 point) const;
  /// At least 0 on the side of a plane of the frustum that the image shows.
  [[nodiscard]] double inside(std::size_t plane, const Corner& corner) const;
  [[nodiscard]] Polygon clipped(const Polygon& polygon, std::size_t plane) const;

  std::array<double, 3> eye_;
  std::array<std::array<double, 3>, 3> axes_;  ///< right and up, in halves of the image, and back
  double near_, far_;
  bool orthographic_, is_empty_ = true;
  /// The box in the image around what it shows.
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
