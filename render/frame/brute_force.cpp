#include "render/frame/brute_force.h"

#include <algorithm>
#include <vector>

namespace raysheaf {
namespace {

constexpr std::size_t kRayTile = 128;
constexpr std::uint32_t kTriangleTile = 512;  // nine arrays of 2 KiB stay in the first-level cache

/// Consecutive triangles in the kernel's format.
struct TriangleTile {
  float vertex[3][3][kTriangleTile];

  [[nodiscard]] TriangleArrays read(const TriangleSource& source, std::uint32_t first,
                                    std::uint32_t count) {
    TriangleArrays arrays;
    std::uint32_t i = 0;
    source.for_each_part(first, first + count,
                         [&](const TriangleRun& run, std::uint32_t from, std::uint32_t to) {
                           for (std::uint32_t t = from; t < to; ++t, ++i) put(run.corners(t), i);
                         });
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) arrays.vertex[k][axis] = vertex[k][axis];
    arrays.first_id = first;
    arrays.count = count;
    arrays.flags = source.flags;
    return arrays;
  }

 private:
  void put(const std::array<Vec3, 3>& corners, std::uint32_t i) {
    for (std::size_t k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) vertex[k][axis][i] = component(corners[k], axis);
  }
};

}  // namespace

void intersect_brute_force(const Executor& executor, const TriangleSource& triangles,
                           View<const Ray> rays, Facing facing, View<RayHit> best,
                           ProgressMeter* meter) {
  executor.for_each_block(rays.size, kRayTile, [&](std::size_t begin, std::size_t end) {
    TriangleTile tile;
    std::vector<RaySetup> setups;
    for (std::size_t i = begin; i < end; ++i) setups.push_back(make_ray_setup(rays[i]));
    for (std::uint32_t first = 0; first < triangles.count; first += kTriangleTile) {
      const TriangleArrays arrays =
          tile.read(triangles, first, std::min(kTriangleTile, triangles.count - first));
      for (std::size_t i = begin; i < end; ++i)
        intersect_list(setups[i - begin], arrays, facing, &best[i]);
    }
    meter->advance(end - begin);
  });
}

}  // namespace raysheaf
