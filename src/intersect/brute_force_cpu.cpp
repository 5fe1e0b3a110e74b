#include "intersect/brute_force.h"

#include <algorithm>
#include <vector>

namespace raysheaf {
namespace {

constexpr std::size_t kRayTile = 64;
constexpr std::uint32_t kTriangleTile = 512;  // nine arrays of 2 KiB stay in the first-level cache

}  // namespace

TriangleArrays triangle_run(const TriangleView& triangles, std::uint32_t first,
                            std::uint32_t count) {
  TriangleArrays run;
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) run.vertex[k][axis] = triangles.vertex[k][axis] + first;
  run.first_id = first;
  run.count = count;
  run.flags = triangles.flags;
  return run;
}

void intersect_brute_force(const Executor& executor, const TriangleView& triangles,
                           View<const Ray> rays, Facing facing, View<RayHit> best,
                           ProgressMeter* meter) {
  executor.for_each_block(rays.size, kRayTile, [&](std::size_t begin, std::size_t end) {
    std::vector<RaySetup> setups;
    for (std::size_t i = begin; i < end; ++i) setups.push_back(make_ray_setup(rays[i]));
    for (std::uint32_t first = 0; first < triangles.count; first += kTriangleTile) {
      const auto tile =
          triangle_run(triangles, first, std::min(kTriangleTile, triangles.count - first));
      for (std::size_t i = begin; i < end; ++i) {
        intersect_list(setups[i - begin], tile, facing, &best[i]);
      }
    }
    meter->advance(end - begin);
  });
}

}  // namespace raysheaf
