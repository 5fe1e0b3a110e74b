// Makes a rasterised picture agree with the rays through its pixels' centres.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "rays/camera_body.h"

namespace raysheaf {

class Executor;
struct FlatScene;

/// OpenGL moves vertices to a grid of 1/256 pixel, and so errs where an edge passes that close to a
/// pixel's centre. Afterwards each pixel holds a triangle that its ray hits by the one ray-triangle
/// test, from a side that shows, or kInvalidId. The pixel sees the least (t, number) among
///  - what it held;
///  - at a border between triangles, what the 3 x 3 pixels around it held;
///  - triangles that span few pixels, which their neighbours may not tell of;
///  - where its ray does not hit what it held, all triangles.
/// What may still be missed is an edge of a long sliver that no neighbour saw. `triangles` is what
/// `Rasterizer::visible_triangles` gave for the same scene and camera. O(triangles + pixels) where
/// the last case is rare. Does not depend on the number of threads. `drawn`: what
/// `visible_triangles` says of that picture, which saves a look at all others.
void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
                         View<const std::uint32_t> drawn, View<std::uint32_t> triangles);
/// The same from the picture alone.
void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
                         View<std::uint32_t> triangles);

}  // namespace raysheaf
