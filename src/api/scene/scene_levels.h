// The two levels of a scene, for queries that do not pay for placing its instances.
#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "api/scene/scene_view.h"
#include "device/device_queries.h"
#include "levels/levels.h"
#include "queries/level_plan.h"
#include "queries/query_report.h"

namespace raysheaf {

/// The instances that a query enters where they stand. The others are placed first.
struct Entered {
  const Levels* levels = nullptr;      ///< of these; null: none
  View<const std::uint8_t> part = {};  ///< not zero for each of them; empty: all, or none
};

/// Thread-safe; the scene must not change during a call, nor while its result is in use.
class SceneLevels {
 public:
  /// The instances that the rays or points that `asked` counts had better enter. Points enter all
  /// or none. Rays enter instances that have moved until that has paid for placing them; those in
  /// worlds enter all instances that are in one, and rays with times all that move. The others are
  /// placed, unless they have few triangles. `flat`: the view of all instances. Adds the reason to
  /// the report, if there is one. Throws `Error` (kUnsupported), naming the instance, where they
  /// cannot enter it and it cannot be placed.
  [[nodiscard]] Entered for_query(const Executor& executor, const SceneRuns& scene,
                                  const SceneView& flat, const LevelWork& asked,
                                  const ItemWorlds& worlds, bool in_time, QueryReport* report);
  /// The same for rays on a device: whether they enter the instances of `engine`, which then has
  /// those of the scene.
  [[nodiscard]] bool on_device(const Executor& executor, const SceneRuns& scene,
                               const SceneView& flat, std::uint64_t rays, DeviceQueries* engine,
                               QueryReport* report);
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
    double since = 0;           ///< `spent_ns` of the plan then
    std::uint64_t settled = 0;  ///< the scene's version of its levels
  };
  struct Asked;
  /// Notes what has changed since the last query. Returns whether any instance may be entered.
  [[nodiscard]] bool look(Asked* asked, Side* side);
  /// Set `entered_`, and return whether any instance is entered: all or none, or a part. `Trees`
  /// are those of the side.
  template <class Trees>
  [[nodiscard]] bool enter_all(const Asked& asked, const Trees& trees, Side* side);
  [[nodiscard]] bool enter_part(const Asked& asked);
  /// Brings the trees to where the instances of `entered_` stand; returns whether they can be
  /// entered.
  template <class Trees>
  [[nodiscard]] bool settle(const Asked& asked, Trees* trees, Side* side);
  void explain(const Asked& asked) const;

  std::mutex mutex_;
  Levels levels_;
  Side here_, there_{.costs = kDeviceCosts};
  std::optional<bool> chosen_;
  std::vector<std::uint8_t> entered_;  ///< by the last query: 1 for each of these instances
  std::size_t entered_count_ = 0;
  std::vector<std::uint8_t> settled_;  ///< the same of `levels_`
  std::vector<double> since_;  ///< `spent_ns` of the plan when an instance was seen to have moved,
  std::uint64_t structure_ = 0, position_ = 0;  ///< at these versions of the scene
  std::uint64_t looked_ = 0;          ///< the scene's version at the last query with times,
  bool moves_ = false;                ///< and whether an instance moved
  std::uint64_t counted_ = 0;         ///< the scene's structure, whose meshes have
  std::uint64_t mesh_triangles_ = 0;  ///< so many triangles
};

}  // namespace raysheaf
