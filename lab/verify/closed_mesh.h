// Closed meshes of which it is known what is inside, for rays through their edges and vertices.
//
//         p ___ p        every vertex p has a core c; the mesh is the boundary of the tetrahedra
//        / \   /|        that its triangles span with their vertices' cores. So for a point e on an
//       p---c-c p        edge, all of the segment from e to the point between the cores is inside,
//        \ /   \|        but for e itself
//         p-----p
#pragma once

#include <string>
#include <vector>

#include "lab/verify/random.h"
#include "raysheaf/scene.h"

namespace raysheaf::checks {

struct ClosedMesh {
  std::string kind;
  std::vector<Vec3> positions, cores;  ///< as many
  std::vector<Triangle> triangles;
  float extent = 0;     ///< the longest side of its box
  float thickness = 0;  ///< how far a core is from the surface, from below
  Vec3 offset;          ///< where it is in the world

  /// "needles of 240 triangles, scale 1e-05, far from the origin"
  [[nodiscard]] std::string text() const;
};

/// A ball, a box, a torus, a spindle whose poles have hundreds of neighbours; rough or smooth; as
/// it is, or stretched so that its triangles are needles; 1e-20 to 1e17 large; at the origin, or as
/// far from it as leaves it thick by many roundings. No triangle is without area but those of which
/// two corners are one point.
[[nodiscard]] ClosedMesh make_closed_mesh(std::uint64_t seed);

}  // namespace raysheaf::checks
