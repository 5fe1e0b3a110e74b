// A rig at a time: the transforms of its nodes, and their effect on the scene.
#pragma once

#include <vector>

#include "animation/placement.h"
#include "exec/executor.h"
#include "raysheaf/rig.h"
#include "raysheaf/scene_changes.h"

namespace raysheaf {

/// `rig` must have passed `validate` with the scene, and outlive this object.
class RigState {
 public:
  explicit RigState(const Rig& rig);

  /// Resets every node and every weight to its value without a curve.
  void rest();
  /// Evaluates the clip's curves at a time; targets without a curve keep their values.
  void apply(const Executor& executor, const RigClip& clip, double time);
  /// Updates the scene to the nodes' transforms: all of it, or what any clip can move. Returns what
  /// has changed.
  SceneChanges write_all(const Executor& executor, SceneDescription& scene);
  SceneChanges write_moving(const Executor& executor, SceneDescription& scene);
  /// The same without the vertices of shapes, whose poses it returns.
  SceneChanges write_poses(const Executor& executor, SceneDescription& scene);
  [[nodiscard]] bool has_unmoved_vertices() const;
  /// Moves the vertices that have been left where they were.
  void move_vertices(const Executor& executor, SceneDescription& scene);

 private:
  /// Numbers of the nodes that can move, sorted by depth, and where each depth begins.
  struct Levels {
    std::vector<std::uint32_t> nodes;
    std::vector<std::size_t> starts;
  };
  /// Objects attached to nodes that can move.
  struct Loads {
    std::vector<std::uint32_t> instances, cameras, lights, shapes;
  };

  [[nodiscard]] std::vector<char> moving_nodes() const;
  [[nodiscard]] Levels levels_of(const std::vector<char>& chosen) const;
  [[nodiscard]] Loads loads_of(const std::vector<char>& chosen, bool all) const;
  void place(const Executor& executor, const Levels& levels);
  enum class Vertices : std::uint8_t { kMove, kLeave };
  SceneChanges write(const Executor& executor, const Loads& loads, Vertices vertices,
                     SceneDescription& scene);
  /// Brings the shape's pose up to date; returns whether it or the vertices are others.
  bool pose_shape(std::uint32_t shape, Vertices vertices);
  void move_shape(const Executor& executor, std::uint32_t shape, SceneDescription& scene);

  const Rig& rig_;
  std::vector<RigNode> local_;  ///< without names
  std::vector<Placement> to_world_;
  std::vector<std::vector<float>> weights_;  ///< of each shape
  /// The last pose of each shape; no joints and no weights before the first one.
  struct Made {
    bool posed = false, moved = false;  ///< `moved`: the vertices, too
    std::vector<float> weights;
    std::vector<Affine> joints;
  };
  std::vector<Made> made_;
  Levels all_, moving_;
  Loads all_loads_, moving_loads_;
};

}  // namespace raysheaf
