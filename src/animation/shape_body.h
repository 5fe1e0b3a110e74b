// One vertex of a mesh that changes its shape (glTF 2.0, sections 3.7.2.2 and 3.7.3).
#pragma once

#include <cstdint>

#include "base/vec.h"
#include "base/view.h"

namespace raysheaf {

/// The moves of a morph target, one a vertex; null where it has none.
struct TargetView {
  const Vec3* positions = nullptr;
  const Vec3* normals = nullptr;
};

/// A `RigShape` (raysheaf/rig.h) at a time, in the memory of the machine that reads it.
struct ShapeView {
  View<const Vec3> positions, normals;  ///< at rest; no normals: the mesh has none
  View<const TargetView> targets;
  View<const float> weights;            ///< one a target
  std::uint32_t joints_per_vertex = 0;  ///< 0: there is no skin
  View<const std::uint32_t> joints;
  View<const float> joint_weights;
  View<const Affine> joint_maps;  ///< from the mesh at rest to where its instances take it up
};

/// `sum`, moved by all targets; `field`: one of `TargetView`.
RAYSHEAF_HD inline Vec3 morphed(const ShapeView& shape, const Vec3* TargetView::*field, Vec3 sum,
                                std::size_t vertex) {
  for (std::size_t t = 0; t < shape.weights.size; ++t) {
    const Vec3* const moves = shape.targets.data[t].*field;
    const float weight = shape.weights.data[t];
    if (weight != 0 && moves != nullptr) sum += moves[vertex] * weight;
  }
  return sum;
}

/// The mean of the joints' maps, weighted. A vertex that no joint pulls stays.
RAYSHEAF_HD inline Affine blended(const ShapeView& shape, std::size_t vertex) {
  const std::size_t first = vertex * shape.joints_per_vertex;
  float total = 0;
  for (std::size_t i = 0; i < shape.joints_per_vertex; ++i)
    total += shape.joint_weights.data[first + i];
  if (!(total > 0)) return {};
  Affine sum;
  for (auto& row : sum.m) row = {0, 0, 0, 0};
  for (std::size_t i = 0; i < shape.joints_per_vertex; ++i) {
    const float weight = shape.joint_weights.data[first + i] / total;
    if (weight == 0) continue;
    const Affine& joint = shape.joint_maps.data[shape.joints.data[first + i]];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 4; ++c) sum.m[r][c] += weight * joint.m[r][c];
    }
  }
  return sum;
}

/// Writes the vertex to its mesh's `positions`, and to `normals` where the shape has any.
RAYSHEAF_HD inline void deform_vertex(const ShapeView& shape, std::size_t vertex, Vec3* positions,
                                      Vec3* normals) {
  const bool skinned = shape.joints_per_vertex != 0;
  const Affine map = skinned ? blended(shape, vertex) : Affine{};
  const Vec3 position =
      morphed(shape, &TargetView::positions, shape.positions.data[vertex], vertex);
  positions[vertex] = skinned ? transform_point(map, position) : position;
  if (shape.normals.empty()) return;
  const Vec3 rest = shape.normals.data[vertex];
  const Vec3 normal = morphed(shape, &TargetView::normals, rest, vertex);
  normals[vertex] = normalized(skinned ? transform_normal(map, normal) : normal, rest);
}

/// Gives a triangle's vertices, which are its own, the normal of its plane.
RAYSHEAF_HD inline void flatten_normals_of(const std::uint32_t (&corner)[3], const Vec3* positions,
                                           Vec3* normals) {
  const Vec3 a = positions[corner[0]], b = positions[corner[1]], c = positions[corner[2]];
  const Vec3 normal = normalized(cross(b - a, c - a), normals[corner[0]]);
  for (const std::uint32_t v : corner) normals[v] = normal;
}

}  // namespace raysheaf
