// The implementation of `Scene`: meshes and instances by id, their changes that wait for a commit,
// and the runs of triangles that queries see.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "api/scene/context_impl.h"
#include "api/scene/scene_arrays.h"
#include "api/scene/scene_gate.h"
#include "api/scene/scene_levels.h"
#include "api/scene/scene_view.h"
#include "base/large.h"
#include "raysheaf/scene.h"

namespace raysheaf {

/// Reports exhausted memory as `Error`.
template <class Body>
decltype(auto) translated(const Body& body) {
  return within_memory("there is not enough memory", "scene", body);
}

struct Placement;

struct MeshEntry {
  MeshId id = 0;
  MeshArrays arrays;
  std::vector<Placement*> instances;  // by ascending id
  std::uint64_t shape = 0;            // as `PlacedInstance::shape`
  double reach = -1;                  // at least the largest coordinate of a corner; below 0:
                                      // unknown
};

struct Placement {
  InstanceId id = 0;
  MeshEntry* mesh = nullptr;
  Affine to_world;
  std::vector<Affine> motion;  // empty, or where it moves from `to_world` on
  std::uint32_t mask = 0;
  WorldId world = kAllWorlds;
  bool stale = false;          // moved since the last commit; listed in `stale_`
  std::uint32_t run = kNoRun;  // its number in SceneRuns
  static constexpr std::uint32_t kNoRun = kInvalidId;
};

class Scene::Impl {
 public:
  explicit Impl(const Context& where) : context(where) {}

  MeshId add(View<const Vec3> positions, const View<const Triangle>* triangles,
             const MeshOptions& options);
  void replace(MeshId mesh, View<const Vec3> positions, const View<const Triangle>* triangles);
  void update(MeshId mesh, View<const View<const Vec3>> times);
  void remove(MeshId mesh);
  InstanceId instances(MeshId mesh, View<const Affine> transforms, View<const WorldId> worlds,
                       std::uint32_t mask);
  void remove_instance(InstanceId instance);
  void set_transforms(View<const InstanceId> instances, View<const Affine> transforms,
                      std::size_t each);
  void set_mask(InstanceId instance, std::uint32_t mask);
  void set_world(InstanceId instance, WorldId world);
  void commit();
  void continue_ids(MeshId next_mesh, InstanceId next_instance);
  [[nodiscard]] MeshId next_mesh() const { return next_mesh_; }
  [[nodiscard]] InstanceId next_instance() const { return next_instance_; }

  [[nodiscard]] const MeshEntry& mesh(MeshId id) const;
  [[nodiscard]] const Placement& placement(InstanceId id) const;
  [[nodiscard]] const Executor& executor() const { return ContextAccess::executor(context); }
  void require_committed() const;
  [[nodiscard]] Box bounds();
  [[nodiscard]] std::size_t memory_bytes();

  const Context context;
  SceneGate gate;
  // The elements of these maps have stable addresses, and point to each other.
  std::map<MeshId, MeshEntry> meshes;
  std::unordered_map<InstanceId, Placement> placements;
  SceneRuns runs;  // as committed
  SceneViews views;
  SceneLevels levels;
  bool committed = false;
  double pending_ms = 0;            // spent on changes since the last commit
  double update_ms = 0;             // spent on the changes before the last commit, and on that
                                    // commit
  const LargeMemoryKeeper results;  // reuses memory of results of `all_hits` that the caller has
                                    // destroyed

 private:
  MeshEntry& find(MeshId id);
  void set_shape(MeshEntry* mesh);
  [[nodiscard]] bool stays_in_world(MeshEntry* mesh, const Affine& to_world);
  Placement& find_instance(InstanceId id);
  void place(MeshEntry* mesh, View<const Affine> transforms, View<const WorldId> worlds,
             std::uint32_t mask);
  void mark_moved(Placement* placement);
  void check_new_ids(std::uint64_t new_meshes, std::uint64_t new_instances) const;

  [[nodiscard]] std::vector<Placement*> moved_placements();
  void list_runs();
  void place_runs(const std::vector<Placement*>& moved);
  void list_marks();

  std::uint64_t last_shape_ = 0;
  MeshId next_mesh_ = 0;
  InstanceId next_instance_ = 0;
  std::vector<InstanceId> stale_;  // may include instances that were removed
  bool structure_changed_ = true;  // triangles differ from the committed ones
  bool masks_changed_ = false, worlds_changed_ = false;
  std::mutex bounds_mutex_;
  std::optional<Box> bounds_;  // since the last commit
};

struct SceneAccess {
  using State = Scene::Impl;
  static State& state(const Scene& scene) {
    if (scene.impl_ == nullptr)
      throw Error(ErrorCode::kWrongState, "the scene was moved from", "scene");
    return *scene.impl_;
  }
};

}  // namespace raysheaf
