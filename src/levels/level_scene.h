// A scene of two levels: a tree over its instances, and under each the tree of its mesh, which
// instances share.
//
//   top      [ . . . ]            boxes of instances in the world
//             |   |  \.
//   meshes   [.] [. .] [.]        boxes and triangles in the space of the mesh
//
// An instance that moves changes a matrix and a box: no vertex is touched. The triangles that rays
// meet are those of the flat scene (scene/placed_runs.h): their corners are placed where a ray may
// hit them, by the operations that place vertices. A triangle is named by its instance and its
// number in the mesh, so that there may be any number of them in all.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/aligned.h"
#include "base/view.h"
#include "exec/executor.h"
#include "object_tree/object_tree.h"
#include "raysheaf/types.h"
#include "scene/placing.h"

namespace raysheaf {

/// Which queries see an instance.
struct LevelMark {
  std::uint32_t mask = 0xffffffff;
  WorldId world = kAllWorlds;
};

class MovingMesh;

/// Its first three cache lines hold everything that a ray needs to enter it.
struct alignas(kCacheLineBytes) LevelInstance {
  const ObjectTree* tree = nullptr;  ///< of the mesh, as `build_mesh_tree` makes it; not empty
  std::uint32_t mask = 0xffffffff;   ///< a ray enters it if this and its own mask share a bit
  bool mirrored = false;             ///< the transform turns the winding
  Placing placing;
  std::uint32_t geom_id = 0, inst_id = 0;  ///< in hits
  const std::uint8_t* flags = nullptr;     ///< as `PlacedInstance` has them
  const MovingMesh* moving = nullptr;      ///< unless null, the mesh at all times
};
static_assert(offsetof(LevelInstance, placing) + offsetof(Placing, box_pad) <= 3 * kCacheLineBytes);

class Forest;

struct LevelScene {
  View<const LevelInstance> instances;
  const ObjectTree* top = nullptr;  ///< as `build_top_tree` makes it; of items in all worlds
  const Forest* forest = nullptr;   ///< of items in one world (levels/forest.h)
  /// Unless null, the times of rays: a ray meets an instance where `motions` has it at the ray's
  /// time, as `LevelInstance::moving` has its mesh then, and the boxes of the trees above hold it
  /// at all times. An empty motion: the instance stands still.
  const float* times = nullptr;
  const View<const Affine>* motions = nullptr;
};

/// A tree over all triangles of a mesh: those without area too, because a triangle whose corners
/// are in line may have an area once it is placed. `source` is the mesh in its own space. O(M).
void build_mesh_tree(const Executor& executor, const TriangleSource& source, ObjectTree* tree);

/// How well a box in the world fits a turned mesh: made of up to 8 boxes of its tree, or of up to
/// 64.
enum class BoxFit { kQuick, kClose };
/// Close where there are more than 64, for which many rays pay.
[[nodiscard]] BoxFit fit_for(std::size_t instances);

/// A box, in the world, of a mesh with these nodes, the root first.
[[nodiscard]] Box world_box(const Placing& placing, const BvhNode* nodes, BoxFit fit);
/// A box of the instance in the world; and one that holds it from a time to another.
[[nodiscard]] Box world_box(const LevelInstance& instance, BoxFit fit);
[[nodiscard]] Box world_box(const LevelInstance& instance, BoxFit fit, View<const Affine> motion,
                            float begin = 0, float end = 1);

/// A tree over these of the instances' boxes in the world; without `members`, over all. A leaf is
/// one instance, whose number is its `first`; there are no quads. O(instances log instances).
void build_top_tree(const Executor& executor, View<const Box> boxes, ObjectTree* top,
                    View<const std::uint32_t> members = {});
/// The same tree over boxes of the same instances elsewhere; its `surface_area_cost` tells what
/// that has cost. O(instances).
void refit_top_tree(const Executor& executor, View<const Box> boxes, ObjectTree* top);

}  // namespace raysheaf
