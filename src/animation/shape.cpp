#include "animation/shape.h"

#include "base/vec.h"

namespace raysheaf {
namespace {

Vec3 morphed(const std::vector<Vec3>& rest, std::vector<Vec3> MorphTarget::*field,
             const RigShape& shape, std::span<const float> weights, std::size_t vertex) {
  Vec3 sum = rest[vertex];
  for (std::size_t t = 0; t < weights.size(); ++t) {
    const std::vector<Vec3>& moves = shape.targets[t].*field;
    if (weights[t] != 0 && !moves.empty()) sum += moves[vertex] * weights[t];
  }
  return sum;
}

/// The weighted mean of the joints' maps. A vertex without joints does not move.
Affine blended(const RigShape& shape, std::span<const Affine> joints, std::size_t vertex) {
  const std::size_t first = vertex * shape.joints_per_vertex;
  float total = 0;
  for (std::size_t i = 0; i < shape.joints_per_vertex; ++i) total += shape.joint_weights[first + i];
  if (!(total > 0)) return {};
  Affine sum;
  for (auto& row : sum.m) row = {0, 0, 0, 0};
  for (std::size_t i = 0; i < shape.joints_per_vertex; ++i) {
    const float weight = shape.joint_weights[first + i] / total;
    if (weight == 0) continue;
    const Affine& joint = joints[shape.joints[first + i]];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 4; ++c) sum.m[r][c] += weight * joint.m[r][c];
    }
  }
  return sum;
}

void flatten_normals(const RigShape& shape, Mesh* mesh) {
  for (const std::uint32_t t : shape.flat_triangles) {
    const auto& corner = mesh->triangles[t];
    const Vec3 a = mesh->positions[corner[0]], b = mesh->positions[corner[1]],
               c = mesh->positions[corner[2]];
    const Vec3 normal = normalized(cross(b - a, c - a), mesh->normals[corner[0]]);
    for (const std::uint32_t v : corner) mesh->normals[v] = normal;
  }
}

}  // namespace

void deform(const Executor& executor, const RigShape& shape, std::span<const float> weights,
            std::span<const Affine> joints, Mesh* mesh) {
  executor.for_each(shape.positions.size(), kWorkGrain, [&](std::size_t v) {
    const bool skinned = shape.joints_per_vertex != 0;
    const Affine map = skinned ? blended(shape, joints, v) : Affine{};
    const Vec3 position = morphed(shape.positions, &MorphTarget::positions, shape, weights, v);
    mesh->positions[v] = skinned ? transform_point(map, position) : position;
    if (shape.normals.empty()) return;
    const Vec3 rest = shape.normals[v];
    const Vec3 normal = morphed(shape.normals, &MorphTarget::normals, shape, weights, v);
    mesh->normals[v] = normalized(skinned ? transform_normal(map, normal) : normal, rest);
  });
  flatten_normals(shape, mesh);
}

}  // namespace raysheaf
