// Pairs of a ray and a triangle of an instance, which may move: hard to answer correctly where the
// triangle is at the time of the ray.
#pragma once

#include <array>
#include <vector>

#include "lab/verify/pairs.h"
#include "lab/verify/random.h"

namespace raysheaf::checks {

struct PlacedPair {
  const char* family;              ///< of lab/verify/pairs.h, from which the triangle is
  std::array<Vec3, 3> mesh;        ///< the corners in the space of the mesh
  std::vector<Affine> transforms;  ///< one, or several in time
  float time = 0;
  RayAndTriangle seen;  ///< the ray, and the corners where they are at the time
  bool mirrored;        ///< by the transform of the time
};

/// A scene accepts it. The ray is moved as the triangle is, or aims at a corner, an edge or the
/// interior of the triangle where it is. `moves`: at any time, mostly between two to four
/// transforms; otherwise at time 0, where rays can enter the instance (docs/levels.md).
[[nodiscard]] PlacedPair make_placed_pair(bool moves, Random* random);

}  // namespace raysheaf::checks
