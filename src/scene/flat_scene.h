// A scene in the form that the stages of a frame use: every instance's triangles in world space.
//
// Triangles are numbered by (geom_id, inst_id, prim_id), so that comparing two numbers compares the
// three ids in the order that breaks ties between hits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geom/sphere.h"
#include "intersect/triangle_flag.h"
#include "raysheaf/scene_description.h"
#include "scene/placed_runs.h"
#include "scene/transform_points.h"

namespace raysheaf {

class Executor;

/// The triangles of one instance of one mesh, contiguous. An instance without triangles has no
/// FlatMesh.
struct FlatMesh {
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t geom_id = 0, inst_id = 0;
  bool mirrored = false;  ///< the transform reverses the winding
  Sphere bound;           ///< contains every vertex that a triangle uses, in world space
  Box box;                ///< of those vertices
};

struct FlatScene {
  const SceneDescription* description = nullptr;
  std::uint32_t triangle_count = 0;
  PlacedRuns placed;                            ///< where the triangles of `meshes` are, in order
  std::vector<std::uint8_t> flags;              ///< TriangleFlag
  std::vector<std::uint32_t> mesh_of_triangle;  ///< index into `meshes`
  std::vector<FlatMesh> meshes;
  Box bounds;

  [[nodiscard]] TriangleSource source() const {
    return {placed.runs(), triangle_count, flags.data()};
  }
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const TriangleRun& run = placed.runs()[mesh_of_triangle[triangle]];
    return run.corners(triangle - run.first);
  }
};

/// The minimum enclosing sphere of the vertices that each mesh's triangles use, in the mesh's own
/// space; empty without triangles. Computed once for each mesh: moving an instance needs only
/// `transformed` (scene/mesh_bound_body.h).
[[nodiscard]] std::vector<Sphere> mesh_bounds(const Executor& executor,
                                              const SceneDescription& scene);

/// O(triangles). `description` must outlive the result, which reads its vertices, and have passed
/// `validate`; `object_bounds` is the result of `mesh_bounds` for it. Throws `Error`: kUnsupported
/// above 2^31 - 64 triangles, kInvalidData if an instance moves a vertex farther out than
/// `kLargestCoordinate`.
[[nodiscard]] FlatScene flatten(const Executor& executor, const SceneDescription& description,
                                const std::vector<Sphere>& object_bounds);

}  // namespace raysheaf
