// The two levels of a scene, for queries that do not pay for placing its instances.
#pragma once

#include <mutex>
#include <optional>

#include "api/scene/scene_view.h"
#include "device/device_queries.h"
#include "levels/levels.h"
#include "queries/level_plan.h"
#include "queries/query_report.h"

namespace raysheaf {

/// Thread-safe; the scene must not change during a call, nor while its result is in use.
class SceneLevels {
 public:
  /// The levels, where instances wait to be placed and the rays or points that `asked` counts had
  /// better enter them; null if they are to be placed. Those in worlds always enter, where
  /// instances are in worlds, and rays with times where instances move. `is_flat_new`: the view's
  /// tree would have to be built. Adds the reason to the report, if there is one. Throws `Error`
  /// (kUnsupported), naming the instance, where they cannot enter it and the triangles are too many
  /// to be placed.
  [[nodiscard]] const Levels* for_query(const Executor& executor, const SceneRuns& scene,
                                        bool is_flat_new, const LevelWork& asked,
                                        const ItemWorlds& worlds, bool in_time,
                                        QueryReport* report);
  /// The same for rays on a device: whether they enter the instances of `engine`, which then has
  /// those of the scene.
  [[nodiscard]] bool on_device(const Executor& executor, const SceneRuns& scene, bool is_flat_new,
                               std::uint64_t rays, DeviceQueries* engine, QueryReport* report);
  /// From now on rays and points enter instances wherever they can, or never; without a value the
  /// plan decides.
  void choose(std::optional<bool> enter);
  [[nodiscard]] std::size_t memory_bytes();

 private:
  /// The levels in the memory of the CPU or of a device.
  struct Side {
    LevelCosts costs = {};
    LevelPlan plan = {};
    /// An instance that they cannot enter, if any is known.
    InstanceId refuses_rays = kInvalidId, refuses_points = kInvalidId;
    std::uint64_t seen = 0;     ///< the scene's version at the last query
    std::uint64_t settled = 0;  ///< and that of its levels
  };
  struct Asked {
    const Executor& executor;
    const SceneRuns& scene;
    bool is_flat_new;
    LevelWork work;
    bool by_world, moves;  ///< `moves`: rays have times, and instances move
    QueryReport* report;
  };
  /// Whether `asked` enters; `Trees` are those of the side.
  template <class Trees>
  [[nodiscard]] bool enters(const Asked& asked, Trees* trees, Side* side);

  std::mutex mutex_;
  Levels levels_;
  Side here_, there_{.costs = kDeviceCosts};
  std::optional<bool> chosen_;
  std::uint64_t looked_ = 0;          ///< the scene's version at the last query with times,
  bool moves_ = false;                ///< and whether an instance moved
  std::uint64_t counted_ = 0;         ///< the scene's structure, whose meshes have
  std::uint64_t mesh_triangles_ = 0;  ///< so many triangles
};

}  // namespace raysheaf
