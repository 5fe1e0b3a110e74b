// A surface of the halls: a grid of vertices over a wall, a column or a sphere, displaced by noise.
#pragma once

#include <cstdint>

#include "exec/executor.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::builtin {

/// A surface that is displaced along its normal, by at most `roughness`.
struct HallPatch {
  enum class Shape : std::uint8_t {
    kWall,    ///< origin + u a + v b; the normal is that of a x b. Its edges are not displaced
    kColumn,  ///< around the axis from `origin` along b, with radius |a|, without ends
    kBall,    ///< around `origin`, with radius |a|
  };
  Shape shape = Shape::kWall;
  Vec3 origin, a, b;
  float roughness = 0;
  const char* name = "";
};

/// The lengths of a patch along u and v: with cells of size s it has about `u v / s^2` of them.
struct PatchExtent {
  float u = 1, v = 1;
};
[[nodiscard]] PatchExtent extent(const HallPatch& patch);

/// The number of a patch's cells along u (around a column or a sphere) and v.
struct PatchGrid {
  std::uint32_t columns = 3, rows = 2;
};
[[nodiscard]] PatchGrid grid_of(const HallPatch& patch, float cells_a_length);
[[nodiscard]] std::uint64_t triangle_count(const HallPatch& patch, PatchGrid grid);

/// The mesh, without gaps: columns and spheres share the vertices of their seam, and walls of a box
/// meet in straight edges. Normals are those of the grid. The same bits with any number of threads.
[[nodiscard]] Mesh hall_mesh(const Executor& executor, const HallPatch& patch, PatchGrid grid);

}  // namespace raysheaf::builtin
