// Rays through the edges and vertices of closed meshes, from inside, which must hit.
#pragma once

#include "lab/verify/closed_mesh.h"

namespace raysheaf::checks {

/// Ray number `index` of a round. Each hits the mesh within its interval, for any rounding: its
/// origin or a point of it is inside, with many roundings between it and the surface, and it aims
/// at a vertex or a point on an edge. Some go along the surface, some enter it from outside;
/// directions have any length.
[[nodiscard]] Ray edge_ray(const ClosedMesh& mesh, std::uint64_t seed, std::uint64_t index);

/// The same, all from one point deep inside.
[[nodiscard]] Ray fan_ray(const ClosedMesh& mesh, std::uint64_t seed, std::uint64_t index);

}  // namespace raysheaf::checks
