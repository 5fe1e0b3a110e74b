// A scene in the form that the stages of a frame use: every instance's triangles in world space.
//
// Triangles are numbered by (geom_id, inst_id, prim_id), so that comparing two numbers compares the
// three ids in the order that breaks ties between hits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geom/sphere.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/types.h"
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

/// A triangle by the index of its instance in `FlatScene::meshes`, and its number in the mesh.
struct TriangleAt {
  std::uint32_t mesh = kInvalidId, prim = kInvalidId;

  friend bool operator==(const TriangleAt&, const TriangleAt&) = default;
};

struct FlatScene {
  const SceneDescription* description = nullptr;
  std::uint32_t triangle_count = 0;
  PlacedRuns placed;                            ///< where the triangles of `meshes` are, in order
  std::vector<std::uint8_t> flags;              ///< TriangleFlag
  std::vector<std::uint32_t> mesh_of_triangle;  ///< index into `meshes`
  std::vector<FlatMesh> meshes;
  Box bounds;
  /// The instances are not placed: there are only `description`, `meshes` without spheres and
  /// boxes, `bounds`, and the instances of `placed`.
  bool stands = false;

  [[nodiscard]] TriangleAt at(std::uint32_t triangle) const {
    const std::uint32_t mesh = mesh_of_triangle[triangle];
    return {mesh, triangle - meshes[mesh].first_triangle};
  }
  /// The number of a triangle. It is unique up to 2^32 triangles.
  [[nodiscard]] std::uint32_t number_of(TriangleAt at) const {
    return meshes[at.mesh].first_triangle + at.prim;
  }

  [[nodiscard]] TriangleSource source() const {
    return {placed.runs(), triangle_count, flags.data()};
  }
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const TriangleRun& run = placed.runs()[mesh_of_triangle[triangle]];
    return run.corners(triangle - run.first);
  }
  [[nodiscard]] std::array<Vec3, 3> corners(TriangleAt at) const {
    if (stands) return InstanceCorners(placed.instances()[at.mesh])(at.prim);
    return placed.runs()[at.mesh].corners(at.prim);
  }
};

/// The minimum enclosing sphere of the vertices that each mesh's triangles use, in the mesh's own
/// space; empty without triangles. Computed once for each mesh: moving an instance needs only
/// `transformed` (scene/mesh_bound_body.h).
[[nodiscard]] std::vector<Sphere> mesh_bounds(const Executor& executor,
                                              const SceneDescription& scene);

/// The most triangles of a flat scene.
inline constexpr std::uint64_t kMostFlatTriangles = (std::uint64_t{1} << 31) - 64;

/// O(triangles). `description` must outlive the result, which reads its vertices, and have passed
/// `validate`; `object_bounds` is the result of `mesh_bounds` for it. Throws `Error`: kUnsupported
/// above `kMostFlatTriangles`, kInvalidData if an instance moves a vertex farther out than
/// `kLargestCoordinate`.
[[nodiscard]] FlatScene flatten(const Executor& executor, const SceneDescription& description,
                                const std::vector<Sphere>& object_bounds);

/// The part of a mesh that differs in a scene that keeps its instances where they stand.
struct MeshShape {
  std::uint64_t version = 0;        ///< differs from that of all former vertices and triangles
  std::vector<std::uint8_t> flags;  ///< `TriangleFlag` of each triangle; empty: none is set
};

/// Lists the instances of a scene where they stand (`FlatScene::stands`), in any number. In
/// `placed` the `inst_id` of an instance is its index in `meshes`; `bounds` is the caller's.
/// `shapes`: one for each mesh, which must outlive the use of the result. O(instances log
/// instances).
void list_standing(const SceneDescription& description, const std::vector<MeshShape>& shapes,
                   FlatScene* scene);
/// The flags of a mesh's triangles, for `MeshShape`.
[[nodiscard]] std::vector<std::uint8_t> shape_flags(const SceneDescription& description,
                                                    const Mesh& mesh);

}  // namespace raysheaf
