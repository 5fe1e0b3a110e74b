// The triangles that a query sees: those of the instances whose mask shares a bit with the query's.
// Instances that rays enter where they stand (api/scene/scene_levels.h) are not among them. Where
// one begins to move, its triangles become a point, so that the tree is refitted there and not
// built again; where it comes to rest, they return.
//
// Most scenes have one mask and one view, which shows everything. Every other set of masks has a
// view of its own, with its own engine over only the triangles of that set, so that invisible
// triangles cost nothing and hide nothing. A few such views are kept.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <string>
#include <vector>

#include "device/backend.h"
#include "device/device_queries.h"
#include "nearest/point_index.h"
#include "queries/planned_queries.h"
#include "raysheaf/points.h"
#include "raysheaf/scene.h"
#include "scene/placed_runs.h"

namespace raysheaf {

/// The scene as committed. Versions tell a view what has changed since its last refresh.
struct SceneRuns {
  struct Note {
    std::uint32_t mask = 0;
    WorldId world = kAllWorlds;
    std::uint64_t moved_at = 0;  ///< `position_version` since it last moved
  };
  PlacedRuns placed;                 ///< the instances that have triangles
  std::vector<Note> notes;           ///< one for each run
  std::vector<std::uint32_t> masks;  ///< the distinct ones, ascending
  bool has_worlds = false;           ///< not all instances are in all worlds
  std::uint64_t structure_version = 0, position_version = 0, mask_version = 0, world_version = 0;
  mutable std::mutex placing;  ///< of who places instances, and of who asks what waits or stands

  /// Changes with every change of the scene.
  [[nodiscard]] std::uint64_t version() const {
    return structure_version + position_version + mask_version + world_version;
  }

  [[nodiscard]] std::size_t memory_bytes() const {
    return placed.memory_bytes() + notes.capacity() * sizeof(Note);
  }
};

/// For errors: that there are too many triangles to be placed, and how many.
[[nodiscard]] std::string counted_triangles(const SceneRuns& scene);

/// The number of the scene's triangles that a query with this mask sees.
[[nodiscard]] std::uint64_t visible_triangles(const SceneRuns& scene, std::uint32_t mask);

class SceneView {
 public:
  /// Shows the runs that have one of `masks` (ascending), or every run.
  SceneView() = default;
  explicit SceneView(std::vector<std::uint32_t> masks)
      : everything_(false), masks_(std::move(masks)) {}

  [[nodiscard]] const std::vector<std::uint32_t>& masks() const { return masks_; }
  /// Applies changes of the scene; takes almost no time if nothing has changed. `entered`: empty,
  /// or not zero for the instances that are not shown because rays enter them; the others must not
  /// wait to be placed.
  void refresh(const SceneRuns& scene, View<const std::uint8_t> entered = {});
  /// Whether its tree would have to be built, not only refitted.
  [[nodiscard]] bool is_new(const SceneRuns& scene) const {
    return structure_version_ != scene.structure_version ||
           !(everything_ || mask_version_ == scene.mask_version);
  }
  /// Whether all changes of the scene are applied, and all instances are shown that its masks let.
  [[nodiscard]] bool is_current(const SceneRuns& scene) const {
    return !is_new(scene) && position_version_ == scene.position_version && is_whole();
  }
  /// Whether no instance is left out because rays entered it.
  [[nodiscard]] bool is_whole() const { return left_out_ == 0; }
  /// Whether its tree has room for an instance's triangles; and whether they are shown, except if
  /// the instance has moved since. Unless `is_new`.
  [[nodiscard]] bool holds(std::size_t instance) const {
    return states_[instance] != State::kAbsent;
  }
  [[nodiscard]] bool has_shown(std::size_t instance) const {
    return states_[instance] == State::kShown;
  }
  [[nodiscard]] TriangleSource source() const { return {runs_, count_, nullptr}; }
  /// The choice by numbers of the view's triangles; it refers to `runs`, which it fills.
  [[nodiscard]] HitFilter filter(const SceneRuns& scene, const HitChoice& choice,
                                 std::vector<FilteredRun>* runs) const;
  /// Converts triangle numbers of hits to ids; `out` has room for as many.
  void name_hits(View<const IndexedHit> hits, Hit* out) const;
  void name_hits(const Executor& executor, View<const IndexedHit> hits, Hit* out) const;
  /// The same for points, whose `prim_id` is the triangle's number.
  void name_points(View<ClosestPoint> found) const;
  /// Changes whenever the triangles that are shown change.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  /// The queries on a device with the triangles of `source()`; created and updated on demand.
  [[nodiscard]] DeviceQueries& device_queries(const Executor& executor,
                                              const DeviceBackend& backend);
  /// The same, with whatever triangles it has.
  [[nodiscard]] DeviceQueries& device_engine(const DeviceBackend& backend);
  /// The host's memory plus the device's.
  [[nodiscard]] std::size_t memory_bytes() const;

  /// Hold it to call any of these functions or to use the members below; a share of it suffices for
  /// those that are const.
  std::shared_mutex mutex;
  PlannedQueries engine;  ///< over `source()`
  PointIndex points;      ///< what points need besides

 private:
  struct Ids {
    MeshId mesh;
    InstanceId instance;
  };
  /// How the view has an instance of the scene.
  enum class State : std::uint8_t {
    kAbsent,   // not in the tree
    kEmptied,  // in the tree, but its triangles are a point
    kShown
  };
  /// Finds the runs of numbers; remembers that of the last.
  class Namer;
  [[nodiscard]] bool shows(std::uint32_t mask) const;
  void list_runs(const SceneRuns& scene, View<const std::uint8_t> entered);
  [[nodiscard]] std::vector<TriangleRange> move_runs(const SceneRuns& scene,
                                                     View<const std::uint8_t> entered);
  void set_run(const SceneRuns& scene, std::size_t instance, State state, std::size_t run);
  void note_first_runs();

  bool everything_ = true;
  std::vector<std::uint32_t> masks_;
  std::vector<State> states_;
  std::uint32_t left_out_ = 0;  // instances that the masks let but that are not shown
  std::vector<TriangleRun> runs_;
  std::vector<Vec3> corners_;  // one of each of `runs_`, which is the point
  std::vector<std::array<std::uint32_t, 3>>
      emptied_;                            // triangles of which all corners are vertex 0
  std::vector<Ids> ids_;                   // of `runs_`
  std::vector<std::uint32_t> first_runs_;  // for each block of numbers, the run at which to start
                                           // searching
  std::uint32_t block_bits_ = 0;           // of the numbers in a block
  std::uint32_t count_ = 0;
  std::uint64_t version_ = 0;
  std::uint64_t structure_version_ = 0, position_version_ = 0, mask_version_ = 0;
  std::unique_ptr<DeviceQueries> device_engine_;
  bool device_is_behind_ = true;  // its triangles are not those of `source()`
  bool device_refits_ = false;    // they are the same triangles, only moved
};

/// The views of one scene. Thread-safe.
class SceneViews {
 public:
  /// The view of all instances.
  [[nodiscard]] const std::shared_ptr<SceneView>& everything() const { return everything_; }
  /// The view for a query; null if it sees no triangle. Valid as long as the scene is.
  [[nodiscard]] std::shared_ptr<SceneView> view_for(const SceneRuns& scene, std::uint32_t mask);
  /// Drops the views of masks that the scene no longer has.
  void forget_old_masks(const SceneRuns& scene);
  [[nodiscard]] std::size_t memory_bytes();

 private:
  static constexpr std::size_t kMostViews = 4;

  std::mutex mutex_;
  std::shared_ptr<SceneView> everything_ = std::make_shared<SceneView>();
  std::vector<std::shared_ptr<SceneView>> masked_;  // most recently used first, at most kMostViews
};

}  // namespace raysheaf
