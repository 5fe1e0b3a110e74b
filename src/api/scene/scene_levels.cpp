#include "api/scene/scene_levels.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "exec/stopwatch.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

std::uint64_t triangles_of_meshes(View<const PlacedInstance> instances) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < instances.size; ++i)
    if (i == 0 || instances[i].geom_id != instances[i - 1].geom_id)
      count += instances[i].triangle_count;
  return count;
}

/// Whether an item is in all worlds.
bool are_in_all(const ItemWorlds& worlds, std::size_t items) {
  return worlds.each != nullptr &&
         std::find(worlds.each, worlds.each + items, kAllWorlds) != worlds.each + items;
}

/// Brings the trees to where the instances stand; notes which rays and points cannot enter.
void settle(const Executor& executor, const PlacedRuns& placed, View<const LevelMark> marks,
            Levels* levels, InstanceId* refuses_rays, InstanceId* refuses_points) {
  *refuses_points = levels->update(executor, placed, marks);
  *refuses_rays = *refuses_points != kInvalidId ? *refuses_points : levels->refuses_rays();
}
void settle(const Executor& executor, const PlacedRuns& placed, View<const LevelMark> marks,
            DeviceQueries* levels, InstanceId* refuses_rays, InstanceId* /*refuses_points*/) {
  *refuses_rays = levels->set_instances(executor, placed.instances(), marks);
}

}  // namespace

template <class Trees>
bool SceneLevels::enters(const Asked& asked, Trees* trees, Side* side) {
  const SceneRuns& scene = asked.scene;
  const bool of_points = asked.work.points != 0, by_world = asked.by_world, moves = asked.moves;
  // Rays with times meet an instance that they cannot enter by its boxes in the world, as points
  // do.
  const InstanceId& refused = of_points || moves ? side->refuses_points : side->refuses_rays;
  const bool is_new = std::exchange(side->seen, scene.version()) != scene.version();
  if (is_new) side->refuses_rays = side->refuses_points = kInvalidId;
  if (std::exchange(counted_, scene.structure_version) != scene.structure_version)
    mesh_triangles_ = triangles_of_meshes(scene.placed.instances());
  LevelWork work = asked.work;
  work.placed_triangles = scene.placed.triangle_count();
  work.mesh_triangles = mesh_triangles_;
  const bool has_many = work.has_many(side->costs);
  const bool fits = scene.placed.fits(), may_place = fits && !moves;
  if (may_place && (refused != kInvalidId ||
                    !chosen_.value_or(by_world || scene.placed.is_waiting() || has_many)))
    return false;
  const bool is_settled = side->settled == scene.version();
  (asked.is_flat_new ? work.new_triangles : work.moved_triangles) =
      asked.is_flat_new ? scene.placed.triangle_count() : scene.placed.waiting_triangles();
  if (!is_settled && !by_world && !moves) {
    work.missing_triangles = trees->missing_triangles(scene.placed.instances());
    work.instances = scene.notes.size();
  }
  if (may_place && !chosen_ && !by_world && !side->plan.enters(work, is_new, side->costs))
    return false;
  if (!is_settled && refused == kInvalidId) {
    Stopwatch watch;
    side->settled = 0;  // until all is done: memory may run out
    std::vector<LevelMark> marks(scene.notes.size());
    for (std::size_t i = 0; i < marks.size(); ++i)
      marks[i] = {scene.notes[i].mask, scene.notes[i].world};
    settle(asked.executor, scene.placed, View<const LevelMark>(marks), trees, &side->refuses_rays,
           &side->refuses_points);
    if (asked.report != nullptr) asked.report->hierarchy_ms += watch.lap_ms();
    if (side->refuses_points == kInvalidId) side->settled = scene.version();
  }
  if (refused != kInvalidId) {
    if (may_place) return false;
    const std::string why =
        moves ? "no ray with a time can enter it, because its entries are too large"
        : of_points
            ? "no point can enter it, because its entries are too large"
            : "no ray can enter it, because it is singular, squeezes by more than about 1 : "
              "10 000, or leads where float32 moves corners";
    throw Error(ErrorCode::kUnsupported,
                fits ? why : why + "; it cannot be placed either: " + counted_triangles(scene),
                "instances[" + std::to_string(refused) + "].transform");
  }
  const std::string who = of_points ? "points" : "rays";
  if (asked.report != nullptr)
    asked.report->plan.push_back(
        "instances: entered by the " + who + " where they stand, because " +
        (moves      ? "rays have times"
         : by_world ? who + " in one world see few of them"
         : !fits    ? std::to_string(work.placed_triangles) + " triangles cannot be placed"
         : has_many
             ? std::to_string(work.placed_triangles) + " placed triangles would take much memory"
             : std::to_string(work.rays + work.points) + " " + who + " do not pay for placing " +
                   std::to_string(scene.placed.waiting_triangles()) + " triangles"));
  return true;
}

const Levels* SceneLevels::for_query(const Executor& executor, const SceneRuns& scene,
                                     bool is_flat_new, const LevelWork& asked,
                                     const ItemWorlds& worlds, bool in_time, QueryReport* report) {
  const std::scoped_lock lock(mutex_, scene.placing);
  const bool by_world = scene.has_worlds && worlds.are_given();
  if (in_time && std::exchange(looked_, scene.version()) != scene.version())
    moves_ = std::ranges::any_of(scene.placed.instances(), [](const PlacedInstance& instance) {
      return !instance.motion.empty();
    });
  const bool moves = in_time && moves_;
  if (!enters({executor, scene, is_flat_new, asked, by_world, moves, report}, &levels_, &here_))
    return nullptr;
  const Stopwatch watch;
  if (by_world) levels_.update_forest(executor, moves);
  if (!by_world || are_in_all(worlds, asked.rays + asked.points))
    levels_.update_top(executor, moves);
  if (report != nullptr) report->hierarchy_ms += watch.ms();
  return &levels_;
}

bool SceneLevels::on_device(const Executor& executor, const SceneRuns& scene, bool is_flat_new,
                            std::uint64_t rays, DeviceQueries* engine, QueryReport* report) {
  const std::scoped_lock lock(mutex_, scene.placing);
  return enters({executor, scene, is_flat_new, {.rays = rays}, false, false, report}, engine,
                &there_);
}

void SceneLevels::choose(std::optional<bool> enter) {
  const std::lock_guard lock(mutex_);
  chosen_ = enter;
}

std::size_t SceneLevels::memory_bytes() {
  const std::lock_guard lock(mutex_);
  return levels_.memory_bytes();
}

}  // namespace raysheaf
