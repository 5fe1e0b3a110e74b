// Rays that cannot leave: through the edges and vertices of closed meshes, from inside.
#pragma once

#include "lab/verify/closed_mesh.h"

namespace raysheaf::checks {

/// The `index`th ray of a round's. Each meets the mesh within its interval, whatever is rounded: it
/// starts, or is, where many roundings fit between it and the surface, and aims at a vertex or a
/// point on an edge. Along the surface, through it from outside, with directions of any length.
[[nodiscard]] Ray edge_ray(const ClosedMesh& mesh, std::uint64_t seed, std::uint64_t index);

/// The same, all from one point deep inside.
[[nodiscard]] Ray fan_ray(const ClosedMesh& mesh, std::uint64_t seed, std::uint64_t index);

}  // namespace raysheaf::checks
