// From the world to the window.
#pragma once

#include <array>
#include <optional>

#include "raysheaf/scene_description.h"

namespace raysheaf::viewer {

/// A place in a picture: from 0 to 1, from the left and from the top.
struct Spot {
  float x = 0, y = 0;
};

struct SpotPair {
  Spot from, to;
};

/// Column-major, for OpenGL; what is nearer than `near` is cut off. `aspect`: width by height.
[[nodiscard]] std::array<float, 16> view_projection(const Camera& camera, float aspect, float near,
                                                    float far);

/// Where a picture's corners lie in the world, `depth` ahead of the camera: top left, top right,
/// bottom left, bottom right. Drawn there, it looks right from where it was made, and nearly so
/// from close by.
[[nodiscard]] std::array<Vec3, 4> picture_corners(const Camera& camera, float aspect, float depth);

/// The part of a line that lies before the camera; it may leave the picture. None where nothing
/// does.
[[nodiscard]] std::optional<SpotPair> project(const Camera& camera, float aspect, Vec3 from,
                                              Vec3 to);

/// The point `depth` ahead of the camera that is seen at a spot.
[[nodiscard]] Vec3 unproject(const Camera& camera, float aspect, Spot spot, float depth);

}  // namespace raysheaf::viewer
