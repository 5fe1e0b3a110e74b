// Vertex normals for files that have none.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Faces whose normals differ by more than this at a shared position meet in a crease.
inline constexpr double kCreaseCosine = 0.5;  // 60 degrees
/// Where more faces meet at one position they are looked at in runs of this many, in file order:
/// the work stays linear.
inline constexpr std::size_t kMaxFacesAtPosition = 512;

/// Gives a normal to each vertex `v` of which `has_normal[v]` is false (an empty `has_normal`: to
/// all): the sum of the face normals, weighted by area, of the faces that touch its position and
/// form no crease with the face at hand. A vertex that needs several normals is split: the first
/// keeps its place, the others are appended. Triangles keep their order and vertices their
/// positions, uvs and colours. Indices must be in range. O(vertices log vertices + triangles).
/// Returns for each appended vertex one before it that is the same but for its normal.
std::vector<std::uint32_t> add_missing_normals(Mesh& mesh,
                                               const std::vector<bool>& has_normal = {});

}  // namespace raysheaf::io
