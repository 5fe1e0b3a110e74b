// A rig at a time: where its nodes stand, and what that makes of its scene.
#pragma once

#include <vector>

#include "animation/placement.h"
#include "exec/executor.h"
#include "raysheaf/rig.h"
#include "raysheaf/scene_changes.h"

namespace raysheaf {

/// `rig` has passed `validate` with the scene, and outlives this.
class RigState {
 public:
  explicit RigState(const Rig& rig);

  /// Every node and every weight as it is without a curve.
  void rest();
  /// The clip's curves at a time; what none of them drives stays.
  void apply(const Executor& executor, const RigClip& clip, double time);
  /// Brings the scene to where the nodes stand: all of it, or what any clip can move. Returns what
  /// is another.
  SceneChanges write_all(const Executor& executor, SceneDescription& scene);
  SceneChanges write_moving(const Executor& executor, SceneDescription& scene);

 private:
  /// Numbers of the nodes that can move, those of one depth in a row, and where the depths begin.
  struct Levels {
    std::vector<std::uint32_t> nodes;
    std::vector<std::size_t> starts;
  };
  /// What hangs on nodes that can move.
  struct Loads {
    std::vector<std::uint32_t> instances, cameras, lights, shapes;
  };

  [[nodiscard]] std::vector<char> moving_nodes() const;
  [[nodiscard]] Levels levels_of(const std::vector<char>& chosen) const;
  [[nodiscard]] Loads loads_of(const std::vector<char>& chosen, bool all) const;
  void place(const Executor& executor, const Levels& levels);
  SceneChanges write(const Executor& executor, const Loads& loads, SceneDescription& scene);
  bool write_shape(const Executor& executor, std::uint32_t shape, SceneDescription& scene);

  const Rig& rig_;
  std::vector<RigNode> local_;  ///< without names
  std::vector<Placement> to_world_;
  std::vector<std::vector<float>> weights_;  ///< of each shape
  /// What each shape was last made from; no joints and no weights before the first time.
  struct Made {
    bool made = false;
    std::vector<float> weights;
    std::vector<Affine> joints;
  };
  std::vector<Made> made_;
  Levels all_, moving_;
  Loads all_loads_, moving_loads_;
};

}  // namespace raysheaf
