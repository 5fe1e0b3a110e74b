// The two levels of a scene, for queries that do not pay for placing its instances.
#pragma once

#include <mutex>
#include <optional>

#include "api/scene/scene_view.h"
#include "levels/levels.h"
#include "queries/level_plan.h"
#include "queries/query_report.h"

namespace raysheaf {

/// Thread-safe; the scene must not change during a call, nor while its result is in use.
class SceneLevels {
 public:
  /// The levels, where instances wait to be placed and the rays or points that `asked` counts had
  /// better enter them; null if they are to be placed. Rays in worlds always enter, where instances
  /// are in worlds, and rays with times where instances move. `is_flat_new`: the view's tree would
  /// have to be built. Adds the reason to the report, if there is one. Throws `Error`
  /// (kUnsupported), naming the instance, where they cannot enter it and the triangles are too many
  /// to be placed.
  [[nodiscard]] const Levels* for_query(const Executor& executor, const SceneRuns& scene,
                                        bool is_flat_new, const LevelWork& asked,
                                        const ItemWorlds& worlds, bool in_time,
                                        QueryReport* report);
  /// From now on rays and points enter instances wherever they can, or never; without a value the
  /// plan decides.
  void choose(std::optional<bool> enter);
  [[nodiscard]] std::size_t memory_bytes();

 private:
  std::mutex mutex_;
  Levels levels_;
  LevelPlan plan_;
  std::optional<bool> chosen_;
  /// An instance that they cannot enter, if any is known.
  InstanceId refuses_rays_ = kInvalidId, refuses_points_ = kInvalidId;
  std::uint64_t looked_ = 0;          ///< the scene's version at the last query with times,
  bool moves_ = false;                ///< and whether an instance moved
  std::uint64_t counted_ = 0;         ///< the scene's structure, whose meshes have
  std::uint64_t mesh_triangles_ = 0;  ///< so many triangles
  std::uint64_t seen_ = 0;            ///< the scene's version at the last query
  std::uint64_t settled_ = 0;         ///< and that of `levels_`
};

}  // namespace raysheaf
