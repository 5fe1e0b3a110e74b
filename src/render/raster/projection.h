// What takes a point relative to the eye to OpenGL's clip space.
#pragma once

#include <array>

#include "base/vec.h"
#include "rays/camera_body.h"

namespace raysheaf {

/// A 4 x 4 matrix by columns, as OpenGL reads it.
using ClipMatrix = std::array<float, 16>;

/// The matrix under which the rasteriser's pixel (x, y) from the *first* row of the frame buffer is
/// the pixel that `camera_ray(frame, x, y)` goes through: y points down. Depth is reversed, 1 at
/// z_near and 0 at z_far, for glClipControl's zero-to-one: floating point is densest where
/// perspective has squeezed the distances (E. Lapidous, G. Jiao, "Optimal Depth Buffer for Low-Cost
/// Graphics Hardware", Graphics Hardware 1999). `farthest` is a depth that nothing in the scene
/// lies beyond; it stands in for an infinite z_far of an orthographic camera.
[[nodiscard]] ClipMatrix clip_matrix(const CameraFrame& frame, float farthest);

/// The depth of the box's farthest corner, or 0 where that is behind the eye.
[[nodiscard]] float farthest_depth(const CameraFrame& frame, const Box& box);

}  // namespace raysheaf
