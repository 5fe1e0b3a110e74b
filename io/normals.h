// Computes vertex normals for files without normals.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Faces whose normals differ by more than this angle at a shared position meet in a crease.
inline constexpr double kCreaseCosine = 0.5;  // 60 degrees
/// If more faces meet at one position, they are processed in runs of this many, in file order: the
/// time stays linear.
inline constexpr std::size_t kMaxFacesAtPosition = 512;

/// Which faces are smooth with each other: those of one group, or, without a group, those that
/// form no crease.
inline constexpr std::uint32_t kFlat = 0, kByAngle = 0xffffffff;

/// Computes a normal for each vertex `v` with `has_normal[v]` false (if `has_normal` is empty, for
/// all vertices): the area-weighted sum of the normals of the faces that touch its position and are
/// smooth with the vertex's face. `smoothing` has the group of each triangle, `kFlat` or
/// `kByAngle`; if it is empty, all are `kByAngle`. A vertex that needs several normals is split:
/// the first keeps its index, the others are appended. Triangles keep their order, and vertices
/// their positions, uvs and colours. Indices must be in range. O(vertices log vertices +
/// triangles). Returns, for each appended vertex, an earlier one that differs only in its normal.
std::vector<std::uint32_t> add_missing_normals(Mesh& mesh, const std::vector<bool>& has_normal = {},
                                               const std::vector<std::uint32_t>& smoothing = {});

}  // namespace raysheaf::io
