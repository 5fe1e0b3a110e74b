// Projections from the world to the window.
#pragma once

#include <array>
#include <optional>

#include "raysheaf/scene_description.h"

namespace raysheaf::viewer {

/// A position in an image: from 0 to 1, from the left and from the top.
struct Spot {
  float x = 0, y = 0;
};

struct SpotPair {
  Spot from, to;
};

/// Column-major, for OpenGL; geometry nearer than `near` is clipped. `aspect` is width / height.
[[nodiscard]] std::array<float, 16> view_projection(const Camera& camera, float aspect, float near,
                                                    float far);

/// Whether a point of the box may be within the image of this `view_projection`: true for all that
/// show, and for few others.
[[nodiscard]] bool may_show(const std::array<float, 16>& transform, const Box& box);

/// The corners of an image in the world, `depth` ahead of its camera: top left, top right, bottom
/// left, bottom right. Drawn there, it looks right from the position of the camera, and nearly
/// right from close by.
[[nodiscard]] std::array<Vec3, 4> picture_corners(const Camera& camera, float aspect, float depth);

/// The part of a line in front of the camera, which may leave the image. Empty if the line is
/// behind the camera.
[[nodiscard]] std::optional<SpotPair> project(const Camera& camera, float aspect, Vec3 from,
                                              Vec3 to);

/// Depths that contain a box which may surround the camera.
struct DepthRange {
  float near = 0.01f, far = 100;
};
[[nodiscard]] DepthRange depth_range(const Camera& camera, const Box& bounds);

/// Squares on the ground below a box: their side is a power of ten, about a tenth of the box.
struct GroundGrid {
  Vec3 center, right, ahead;  ///< unit vectors along axes
  float cell = 1;
};
/// `up` is a unit vector along an axis.
[[nodiscard]] GroundGrid ground_grid(const Box& bounds, Vec3 up);

/// The point `depth` ahead of the camera that projects to a position.
[[nodiscard]] Vec3 unproject(const Camera& camera, float aspect, Spot spot, float depth);

}  // namespace raysheaf::viewer
