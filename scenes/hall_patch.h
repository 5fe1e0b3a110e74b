// A surface of the halls: a grid of vertices over a wall, a column or a ball, displaced by noise.
#pragma once

#include <cstdint>

#include "exec/executor.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::builtin {

/// What is displaced along its normal, by `roughness` at most.
struct HallPatch {
  enum class Shape : std::uint8_t {
    kWall,    ///< origin + u a + v b; the normal is that of a x b. Its edges stay where they are
    kColumn,  ///< about the axis from `origin` along b, of the radius |a|, without ends
    kBall,    ///< about `origin`, of the radius |a|
  };
  Shape shape = Shape::kWall;
  Vec3 origin, a, b;
  float roughness = 0;
  const char* name = "";
};

/// The lengths of a patch along u and v: with cells of the size s it has about `u v / s^2` of them.
struct PatchExtent {
  float u = 1, v = 1;
};
[[nodiscard]] PatchExtent extent(const HallPatch& patch);

/// How many cells a patch has along u (round a column or a ball) and v.
struct PatchGrid {
  std::uint32_t columns = 3, rows = 2;
};
[[nodiscard]] PatchGrid grid_of(const HallPatch& patch, float cells_a_length);
[[nodiscard]] std::uint64_t triangle_count(const HallPatch& patch, PatchGrid grid);

/// The mesh, without gaps: columns and balls share the vertices of their seam, and walls of a box
/// meet in straight edges. Normals are those of the grid. The same bits with any threads.
[[nodiscard]] Mesh hall_mesh(const Executor& executor, const HallPatch& patch, PatchGrid grid);

}  // namespace raysheaf::builtin
