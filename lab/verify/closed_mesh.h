// Closed meshes with known interior points, for rays through their edges and vertices.
//
//         p ___ p        every vertex p has a core c; the mesh is the boundary of the tetrahedra
//        / \   /|        that its triangles span with their vertices' cores. For a point e on an
//       p---c-c p        edge, the whole segment from e to the point between the cores is inside,
//        \ /   \|        except e itself
//         p-----p
#pragma once

#include <string>
#include <vector>

#include "lab/verify/random.h"
#include "raysheaf/scene.h"

namespace raysheaf::checks {

struct ClosedMesh {
  std::string kind;
  std::vector<Vec3> positions, cores;  ///< the same number
  std::vector<Triangle> triangles;
  float extent = 0;     ///< the longest side of its box
  float thickness = 0;  ///< a lower bound of a core's distance from the surface
  Vec3 offset;          ///< position in the world

  /// "needles of 240 triangles, scale 1e-05, far from the origin"
  [[nodiscard]] std::string text() const;
};

/// A sphere, a box, a torus, or a spindle whose poles have hundreds of neighbours; rough or smooth;
/// unchanged, or stretched so that its triangles are needles; of size 1e-20 to 1e17; at the origin,
/// or so far from it that its thickness still is many roundings. Triangles without area occur only
/// with two equal corners.
[[nodiscard]] ClosedMesh make_closed_mesh(std::uint64_t seed);

}  // namespace raysheaf::checks
