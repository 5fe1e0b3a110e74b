#include "animation/shape.h"

#include <vector>

#include "animation/shape_body.h"

namespace raysheaf {

void deform(const Executor& executor, const RigShape& shape, std::span<const float> weights,
            std::span<const Affine> joints, Mesh* mesh) {
  std::vector<TargetView> targets;
  for (const MorphTarget& target : shape.targets) {
    const auto moves = [](const std::vector<Vec3>& of) { return of.empty() ? nullptr : of.data(); };
    targets.push_back({moves(target.positions), moves(target.normals)});
  }
  const ShapeView view{
      shape.positions, shape.normals,       targets, weights, shape.joints_per_vertex,
      shape.joints,    shape.joint_weights, joints};
  Vec3* const positions = mesh->positions.data();
  Vec3* const normals = mesh->normals.data();
  executor.for_each(shape.positions.size(), kWorkGrain,
                    [&](std::size_t v) { deform_vertex(view, v, positions, normals); });
  for (const std::uint32_t t : shape.flat_triangles) {
    const auto& [a, b, c] = mesh->triangles[t];
    flatten_normals_of({a, b, c}, positions, normals);
  }
}

}  // namespace raysheaf
