// Traces one ray through two levels (levels/level_scene.h): the work of a thread of a device.
//
//   tree over instances ─► box met, mask shared ─► the ray in the space of the mesh ─► down its
//   tree
//                                                  ─► corners placed, and tested as those of a flat
//                                                     scene
//
// A ray enters by the bounds of scene/placing.h, as on the CPU. The answer is that of the triangles
// where `transform_point` places them, bit for bit.
#pragma once

#include "base/mirrors_body.h"
#include "device/tree_walk_body.h"
#include "scene/placing.h"

namespace raysheaf {

/// The tree of a mesh, whose instances share it.
struct DeviceMesh {
  LinearTreeView tree;
  const SharedBox* bounds = nullptr;  ///< of its corners
};

/// The data of an instance that the host sends, besides its transform.
struct InstanceNote {
  std::uint32_t mesh = 0;  ///< its number
  std::uint32_t geom_id = 0, inst_id = 0, mask = 0;
  bool operator==(const InstanceNote&) const = default;
};

struct DeviceInstance {
  Placing placing;
  Box bounds;  ///< of the corners of its mesh
  LinearTreeView tree;
  InstanceNote note;
  bool mirrored;
};

RAYSHEAF_HD inline DeviceInstance make_instance(const Affine& to_world, const DeviceMesh& mesh,
                                                const InstanceNote& note) {
  const Box bounds = box_of(*mesh.bounds);
  return {make_placing(to_world, bounds), bounds, mesh.tree, note, mirrors(to_world)};
}

/// A box of the instance in the world: of eight parts of its mesh, which fit a turned mesh better
/// than its box.
RAYSHEAF_HD inline Box world_box(const DeviceInstance& instance) {
  constexpr std::uint32_t kLevels = 3;
  if (instance.tree.count <= kLinearLeaf) return placed_box(instance.placing, instance.bounds);
  Box world;
  for (std::uint32_t path = 0; path < 1u << kLevels; ++path) {
    std::uint32_t at = 0;
    Box part;
    for (std::uint32_t level = 0; level < kLevels && (at & kLeafBit) == 0; ++level) {
      const LinearNode& node = instance.tree.nodes[at];
      const std::uint32_t side = path >> level & 1;
      part = node.box[side];
      at = node.child[side];
    }
    world = box_union(world, placed_box(instance.placing, part));
  }
  return world;
}

/// The triangles of instances, where they stand, as a ray sees them.
struct InstanceTrees {
  using Found = Hit;
  struct Place {
    std::uint32_t instance = kInvalidId, triangle = kInvalidId;
  };

  /// The tree over instances: the corners a and b of a triangle are those of the box of an
  /// instance, whose number is the triangle's.
  LinearTreeView tree;
  Box scene;
  const DeviceInstance* instances;
  HitChoice choice;  ///< its arrays are on the device; worlds are not among them
  std::uint32_t ray;

  [[nodiscard]] RAYSHEAF_HD LinearTriangle triangle_at(Place place) const {
    const DeviceInstance& instance = instances[place.instance];
    LinearTriangle t = instance.tree.triangles[place.triangle];
    if (instance.placing.is_identity) return t;
    t.a = transform_point(instance.placing.map, t.a);
    t.b = transform_point(instance.placing.map, t.b);
    t.c = transform_point(instance.placing.map, t.c);
    return t;
  }
  template <class Take>
  RAYSHEAF_HD void for_each_in_leaf(Place first, const Take& take) const {
    for (bool more = true; more; ++first.triangle) {
      const LinearTriangle triangle = triangle_at(first);
      more = triangle.ends_leaf == 0;
      take(first, triangle);
    }
  }
  [[nodiscard]] RAYSHEAF_HD bool counts(Place place, const LinearTriangle& triangle,
                                        bool front) const {
    const DeviceInstance& instance = instances[place.instance];
    return choice.takes(ray, {instance.note.inst_id, triangle.id}, instance.mirrored, front);
  }
  [[nodiscard]] RAYSHEAF_HD Found named(Place place, const LinearTriangle& triangle,
                                        const TriangleHit& hit) const {
    const InstanceNote& note = instances[place.instance].note;
    return {hit.t, hit.u, hit.v, triangle.id, note.geom_id, note.inst_id};
  }

  class Walk {
   public:
    RAYSHEAF_HD Walk(const InstanceTrees& trees, const Ray& ray)
        : trees_(trees),
          ray_(ray),
          mask_(trees.choice.mask_of(trees.ray)),
          now_(make_box_ray(ray, trees.scene)),
          world_(now_),
          limit_(ray.t_max) {}
    template <class Leaf>
    RAYSHEAF_HD void run(WalkCounts* counts, const Leaf& leaf) {
      counts_ = counts;
      walk_tree(
          trees_.tree, &now_, counts,
          [&](std::uint32_t place) {
            leaf(Place{instance_, place});
          },
          this);
    }
    RAYSHEAF_HD void shorten_to(float t) {
      limit_ = lesser(limit_, t);
      shorten(&now_, t);
      shorten(&world_, t);
    }
    RAYSHEAF_HD void end() { now_.s_far = world_.s_far = -std::numeric_limits<float>::infinity(); }

    // For `walk_linear_tree`.
    static constexpr bool kTwoLevels = true;
    RAYSHEAF_HD bool descend(std::uint32_t place, LinearTreeView* tree) {
      const LinearTriangle box = tree->triangles[place];
      float near;
      ++counts_->box_tests;
      if (!enters(now_, {box.a, box.b}, &near)) return false;
      const DeviceInstance& instance = trees_.instances[box.id];
      if ((instance.note.mask & mask_) == 0) return false;
      BoxRay inside;
      if (!move_into(in_mesh(instance.placing, ray_), ray_.t_min, limit_, instance.bounds, &inside))
        return false;
      world_ = now_;
      now_ = inside;
      instance_ = box.id;
      *tree = instance.tree;
      return true;
    }
    RAYSHEAF_HD void ascend() { now_ = world_; }

   private:
    const InstanceTrees& trees_;
    const Ray& ray_;
    std::uint32_t mask_;
    WalkCounts* counts_ = nullptr;
    BoxRay now_, world_;  ///< for the boxes of the tree where the ray is; for those of instances
    float limit_;         ///< t of the nearest hit, or t_max
    std::uint32_t instance_ = kInvalidId;
  };
};

}  // namespace raysheaf
