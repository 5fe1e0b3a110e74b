// Trees over the instances of each world, and one over those in all worlds.
//
//   world 0     world 3    world 4 ...        all worlds
//   [. . .]     [. .]      [. . . . .]        [. . . . . . .]
//
// A ray or a point goes down the tree of its world, and down that of all worlds. So it meets no
// boxes of other worlds, which often stand in the same place, and a world is built without the
// others.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/executor.h"
#include "intersect/hit_filter.h"
#include "levels/level_scene.h"

namespace raysheaf {

/// A node, and all below it.
struct TopRoot {
  const ObjectTree* tree = nullptr;  ///< of instances; null: nothing
  std::uint32_t node = 0;
};

/// Where a ray or a point looks for instances.
struct TopRoots {
  TopRoot of[2];
  Box bounds;  ///< of what is below them
};

/// A tree over some instances, refitted while it stays within 1.5 times its cost.
class TopTree {
 public:
  /// The boxes of instances; without `members`, of all that are in it. `is_same`: the members are
  /// those of the last update, and only stand elsewhere. O(n log n), or O(n).
  void update(const Executor& executor, View<const Box> boxes, View<const std::uint32_t> members,
              bool is_same);
  [[nodiscard]] const ObjectTree& tree() const { return tree_; }

 private:
  ObjectTree tree_;
  float cost_when_built_ = 0;
};

class Forest {
 public:
  /// Brings the trees to the boxes of the instances; worlds[i] is the world of boxes[i]. Takes
  /// O(n log n) where worlds have changed, otherwise O(n), and more for worlds of many instances.
  void update(const Executor& executor, View<const Box> boxes, View<const WorldId> worlds);
  [[nodiscard]] TopRoots roots_of(WorldId world) const;
  /// The box of all instances.
  [[nodiscard]] Box bounds() const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct World {
    std::uint32_t begin = 0, end = 0;  ///< of `members_`
    std::uint32_t place = 0;           ///< of its first node in `few_`, or of its tree in `many_`
    Box bounds;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
  };
  void list(View<const WorldId> worlds);

  std::vector<WorldId> world_of_;       ///< each instance
  std::vector<std::uint32_t> members_;  ///< instances by world
  std::vector<WorldId> names_;  ///< of the worlds that have instances of their own, ascending
  std::vector<World> worlds_;   ///< these
  World shared_;                ///< of the instances in all worlds
  ObjectTree few_;              ///< only nodes: the trees of worlds of few instances
  std::vector<TopTree> many_;   ///< of worlds of many, and behind them that of `shared_`
  bool is_new_ = true;          ///< `many_` are over other instances
};

/// The roots of a ray or a point in a world. The scene has a top tree where one is in all worlds,
/// and a forest where one is not.
[[nodiscard]] TopRoots roots_of(const LevelScene& scene, WorldId world);
/// The box of all instances.
[[nodiscard]] Box bounds_of(const LevelScene& scene);

/// The numbers of rays, those of a world together. Empty if they come so, or mostly.
[[nodiscard]] std::vector<std::uint32_t> order_by_world(const Executor& executor,
                                                        const ItemWorlds& worlds,
                                                        std::size_t count);

}  // namespace raysheaf
