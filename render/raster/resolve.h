// Makes a rasterized image agree with the rays through its pixels' centres.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "render/rays/camera_body.h"

namespace raysheaf {

class Executor;
struct FlatScene;

/// OpenGL rounds vertices to a grid of 1/256 pixel, and so errs if an edge passes that close to a
/// pixel's centre. Afterwards each pixel holds a triangle that its ray hits by the ray-triangle
/// test, from a visible side, or kInvalidId. The pixel sees the least (t, number) among
///  - the triangle that it held;
///  - at a border between triangles, those of the 3 x 3 pixels around it;
///  - triangles that span few pixels, which its neighbours may not hold;
///  - if its ray does not hit the triangle that it held, all triangles;
///  - triangles that the pixels around it see by these rules, and so on from pixel to pixel.
/// The last rule settles surfaces that coincide as rays do, the least number among equal distances:
/// OpenGL may draw any of them. They are noticed where one of them is seen next to the other, and
/// at the centroid of each triangle. It may still miss an edge of a long sliver that no neighbour
/// saw, and a part of a hidden surface that coincides with the visible one nowhere else.
/// `triangles` must be the result of `Rasterizer::visible_triangles` for the same scene and camera.
/// O(triangles + pixels) if the last case is rare. Does not depend on the number of threads.
/// `drawn`: the triangles that `visible_triangles` returned for that image, which saves testing all
/// others.
void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
                         View<const std::uint32_t> drawn, View<std::uint32_t> triangles);
/// The same from the image only.
void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
                         View<std::uint32_t> triangles);

}  // namespace raysheaf
