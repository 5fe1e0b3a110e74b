// A scene in the form that the stages use: every instance's triangles in world space, in flat
// arrays.
//
// Triangles are numbered by (geom_id, inst_id, prim_id), so that comparing two numbers compares the
// three ids in the order that breaks ties between hits. Arrays are padded to a whole number of SIMD
// blocks with triangles that no ray hits: each is a point in a sphere of radius `kPaddingRadius`.
#pragma once

#include <cstdint>
#include <vector>

#include "base/aligned.h"
#include "base/view.h"
#include "geom/sphere.h"
#include "intersect/triangle_view.h"
#include "raysheaf/scene_description.h"
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
  AlignedVector<float> vertex[3]
                             [3];  ///< [corner][axis]; zero-area triangles are collapsed to a point
  AlignedVector<float> sphere[4];  ///< centre and radius of each triangle's bounding sphere
  std::vector<std::uint8_t> flags;              ///< TriangleFlag
  std::vector<std::uint32_t> mesh_of_triangle;  ///< index into `meshes`
  std::vector<FlatMesh> meshes;
  Box bounds;

  [[nodiscard]] TriangleView triangles() const;
  [[nodiscard]] Vec3 corner(std::uint32_t triangle, int k) const {
    return {vertex[k][0][triangle], vertex[k][1][triangle], vertex[k][2][triangle]};
  }
};

/// The minimum enclosing sphere of the vertices that each mesh's triangles use, in the mesh's own
/// space; empty without triangles. Computed once for each mesh: moving an instance needs only
/// `transformed` (scene/mesh_bound_body.h).
[[nodiscard]] std::vector<Sphere> mesh_bounds(const Executor& executor,
                                              const SceneDescription& scene);

/// O(triangles). `description` must outlive the result and have passed `validate`; `object_bounds`
/// is the result of `mesh_bounds` for it. Throws `Error`: kUnsupported above 2^31 - 64 triangles,
/// kInvalidData if an instance moves a vertex farther out than `kLargestCoordinate`.
[[nodiscard]] FlatScene flatten(const Executor& executor, const SceneDescription& description,
                                const std::vector<Sphere>& object_bounds);

}  // namespace raysheaf
