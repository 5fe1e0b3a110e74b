// The scene that a renderer shows, brought up to date for each image: in the host's memory, or in a
// device's only, while the host does not need it; or with its instances where they stand, while no
// one needs their triangles in the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exec/executor.h"
#include "raysheaf/renderer.h"
#include "render/entered_scene.h"
#include "render/frame/trace.h"
#include "render/surface/environment.h"
#include "render/surface/texture.h"
#include "scene/flat_update.h"

namespace raysheaf {

class ShownScene {
 public:
  /// `cache` outlives it: hierarchies and devices, which learn of what changes.
  explicit ShownScene(TraceCache& cache) : cache_(cache) {}

  void show(const SceneDescription& scene, const SceneChanges& changes) {
    if (changes.everything) pending_ = behind_ = unbound_ = {};  // of a scene that may be gone
    pending_.add(changes);
    scene_ = &scene;
  }
  /// The next image computes everything.
  void distrust() { pending_.everything = true; }

  /// Null before the first.
  [[nodiscard]] const SceneDescription* description() const { return scene_; }
  /// Checks what is pending, except for vertices that are not moved yet.
  void validate() const;
  /// Whether vertices move, or were moved in a device's memory only.
  [[nodiscard]] bool has_other_shapes() const {
    return !pending_.deformed.empty() || !behind_.deformed.empty();
  }

  /// Decides who places what moves, and moves vertices where that is the host. `host_need`: why the
  /// host needs the triangles of the next image, in words that follow "for"; empty: it does not.
  /// `by_spheres`: that image needs the spheres of meshes.
  /// `entering`: about how many rays of that image may enter instances where they stand; 0: it
  /// needs their triangles.
  void settle(std::string host_need, bool by_spheres, std::uint64_t entering);
  /// Does what is pending, as `settle` has it; an exception leaves everything pending.
  UpdateStatistics update(const Executor& executor);
  /// Brings the host's triangles to where the device's are.
  void catch_up(const Executor& executor);

  /// Its arrays may be behind the device's. Where `TraceCache::entered`, its instances wait.
  [[nodiscard]] const FlatScene& flat() const { return cache_.entered ? entered_.scene() : flat_; }
  [[nodiscard]] const TextureSet& textures() const { return *textures_; }
  [[nodiscard]] const EnvironmentView& environment() const { return environment_->view(); }
  /// A sentence on how the moving instances were placed, or why they were not; empty if none moved.
  [[nodiscard]] const std::string& placing() const { return placing_; }

 private:
  [[nodiscard]] UpdateStatistics count_changes(const SceneChanges& changes) const;
  void move_vertices(const SceneChanges& changes) const;
  void place_here(const Executor& executor, const SceneChanges& changes, UpdateStatistics* update);
  void place_there(const Executor& executor, const SceneChanges& changes, UpdateStatistics* update);
  /// False where instances have to be placed, or had better be.
  [[nodiscard]] bool enter(const Executor& executor, const SceneChanges& changes,
                           UpdateStatistics* update);
  /// False where the device refuses.
  [[nodiscard]] bool move_there(const SceneChanges& changes,
                                const std::vector<std::uint32_t>& places);
  [[nodiscard]] std::uint64_t bound_there();

  TraceCache& cache_;
  const SceneDescription* scene_ = nullptr;
  SceneChanges pending_;
  SceneChanges behind_;  ///< done on a device or by entering, and not by the host
  /// Meshes whose shapes a device has changed since their spheres were found.
  SceneChanges unbound_;
  bool there_ = false;          ///< the device places what is pending
  bool by_spheres_ = false;     ///< the next image needs the spheres of meshes
  std::uint64_t entering_ = 0;  ///< rays of the next image that may enter instances
  std::string placing_;
  std::vector<Sphere> object_bounds_;
  FlatScene flat_;
  EnteredScene entered_;
  std::optional<TextureSet> textures_;
  std::optional<EnvironmentMap> environment_;
};

}  // namespace raysheaf
