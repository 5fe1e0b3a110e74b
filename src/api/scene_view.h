// The triangles that a query sees: those of the instances whose masks it shares a bit with.
//
// Most scenes have one mask and one view, which shows everything. Any other set of masks has a view
// of its own, with an engine of its own over the triangles of that set alone, so that what is not
// seen costs nothing and hides nothing. A few of them are kept.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "device/backend.h"
#include "device/device_queries.h"
#include "queries/planned_queries.h"
#include "raysheaf/scene.h"

namespace raysheaf {

/// The triangles of one instance, all numbers counted over the whole scene.
struct SceneRun {
  TriangleRun triangles;
  MeshId mesh = 0;
  InstanceId instance = 0;
  std::uint32_t mask = 0;
  std::uint64_t moved_at = 0;  ///< `SceneRuns::position_version` since it last moved
};

/// The scene as it was committed. Versions tell a view what has changed since it looked.
struct SceneRuns {
  std::vector<SceneRun> runs;        ///< by (mesh, instance); none empty
  std::vector<std::uint32_t> masks;  ///< those of `runs`, each once, ascending
  std::uint64_t triangle_count = 0;
  std::uint64_t structure_version = 0, position_version = 0, mask_version = 0;
};

/// Those of its triangles that a query with this mask sees.
[[nodiscard]] std::uint64_t visible_triangles(const SceneRuns& scene, std::uint32_t mask);

class SceneView {
 public:
  /// Shows the runs that have one of `masks` (ascending), or every run.
  SceneView() = default;
  explicit SceneView(std::vector<std::uint32_t> masks)
      : everything_(false), masks_(std::move(masks)) {}

  [[nodiscard]] const std::vector<std::uint32_t>& masks() const { return masks_; }
  /// Takes over what has changed; next to nothing where nothing has.
  void refresh(const SceneRuns& scene);
  [[nodiscard]] TriangleSource source() const { return {runs_, count_, nullptr}; }
  /// Hits by ids; `out` has room for as many.
  void name_hits(View<const IndexedHit> hits, Hit* out) const;
  void name_hits(const Executor& executor, View<const IndexedHit> hits, Hit* out) const;
  /// The engine on a device, with the triangles of `source()`; made and filled where it must be.
  [[nodiscard]] DeviceQueries& device_queries(const Executor& executor,
                                              const DeviceBackend& backend);
  /// Of the host's memory, and of a device's.
  [[nodiscard]] std::size_t memory_bytes() const;

  std::mutex mutex;       ///< held by whoever calls any of these or uses what is below
  PlannedQueries engine;  ///< over `source()`

 private:
  struct Ids {
    MeshId mesh;
    InstanceId instance;
  };
  [[nodiscard]] bool shows(std::uint32_t mask) const;
  void note_first_runs();

  bool everything_ = true;
  std::vector<std::uint32_t> masks_;
  std::vector<TriangleRun> runs_;
  std::vector<Ids> ids_;                   // of `runs_`
  std::vector<std::uint32_t> first_runs_;  // where to look from for a block of numbers' runs
  std::uint32_t block_bits_ = 0;           // of the numbers in a block
  std::uint32_t count_ = 0;
  std::uint64_t structure_version_ = 0, position_version_ = 0, mask_version_ = 0;
  std::unique_ptr<DeviceQueries> device_engine_;
  bool device_is_behind_ = true;  // it has other triangles than `source()`
  bool device_refits_ = false;    // those that it has, only moved
};

/// The views of one scene. For any number of threads.
class SceneViews {
 public:
  /// The view of a query; null where it sees nothing at all.
  [[nodiscard]] std::shared_ptr<SceneView> view_for(const SceneRuns& scene, std::uint32_t mask);
  /// Drops the views of masks that the scene has no longer.
  void forget_old_masks(const SceneRuns& scene);
  [[nodiscard]] std::size_t memory_bytes();

 private:
  static constexpr std::size_t kMostViews = 4;

  std::mutex mutex_;
  std::shared_ptr<SceneView> everything_ = std::make_shared<SceneView>();
  std::vector<std::shared_ptr<SceneView>> masked_;  // latest use first, kMostViews at most
};

}  // namespace raysheaf
