// Makes a rasterised picture agree with the rays through its pixels' centres.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

class Executor;
struct FlatScene;

/// Where the 3 x 3 pixels around a pixel do not all hold the same triangle, its centre's ray is
/// tested with each triangle among them, by the one ray-triangle test, and the least (t, number)
/// that faces the camera as its flags want is what the pixel sees. Where none is hit, the pixel
/// keeps its triangle, unless the background is among its neighbours: then it sees that.
/// What remains is what no neighbour tells of: triangles that are nowhere a pixel wide. Pixels away
/// from such borders are left alone. `triangles` is what `Rasterizer::visible_triangles` gave.
void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const Camera& camera,
                         std::uint32_t width, std::uint32_t height, View<std::uint32_t> triangles);

}  // namespace raysheaf
