// The matrix from points relative to the eye to OpenGL's clip space.
#pragma once

#include <array>

#include "base/vec.h"
#include "render/rays/camera_body.h"

namespace raysheaf {

/// A 4 x 4 matrix by columns, as in OpenGL.
using ClipMatrix = std::array<float, 16>;

/// The matrix for which the rasterizer's pixel (x, y) from the *first* row of the frame buffer is
/// the pixel through which `camera_ray(frame, x, y)` passes: y points down. Depth is reversed, 1 at
/// z_near and 0 at z_far, for glClipControl's zero-to-one: floating point is densest where
/// perspective compresses distances (E. Lapidous, G. Jiao, "Optimal Depth Buffer for Low-Cost
/// Graphics Hardware", Graphics Hardware 1999). `farthest` is an upper bound of the scene's depth;
/// it replaces an infinite z_far of an orthographic camera.
[[nodiscard]] ClipMatrix clip_matrix(const CameraFrame& frame, float farthest);

/// The depth of the box's farthest corner, or 0 if that is behind the eye.
[[nodiscard]] float farthest_depth(const CameraFrame& frame, const Box& box);

}  // namespace raysheaf
