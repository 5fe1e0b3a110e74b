#include "api/scene/scene_levels.h"

#include <algorithm>
#include <string>
#include <type_traits>
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

/// So many instances of a mesh save memory where they are not placed.
constexpr std::size_t kCrowd = 4;

}  // namespace

/// A query.
struct SceneLevels::Asked {
  const Executor& executor;
  const SceneRuns& scene;
  const SceneView& flat;
  LevelWork work;
  bool by_world, moves;  ///< `moves`: rays have times, and instances move
  QueryReport* report;

  [[nodiscard]] bool of_points() const { return work.points != 0; }
  /// Whether all instances could be placed in place of being entered.
  [[nodiscard]] bool may_place() const { return scene.placed.fits() && !moves; }
  /// Whether an instance is not in the flat view as it stands.
  [[nodiscard]] bool waits(std::size_t instance) const {
    return flat.is_new(scene) || !flat.has_shown(instance) || scene.placed.waits(instance);
  }
  /// One that cannot be entered, if any is known.
  [[nodiscard]] InstanceId refused(const Side& side) const {
    // Rays with times meet an instance that they cannot enter by its boxes in the world, as
    // points do.
    return of_points() || moves ? side.refuses_points : side.refuses_rays;
  }
};

bool SceneLevels::look(Asked* asked, Side* side) {
  const SceneRuns& scene = asked->scene;
  if (std::exchange(side->seen, scene.version()) != scene.version()) {
    side->refuses_rays = side->refuses_points = kInvalidId;
    side->since = side->plan.spent_ns();
  }
  if (std::exchange(counted_, scene.structure_version) != scene.structure_version)
    mesh_triangles_ = triangles_of_meshes(scene.placed.instances());
  asked->work.placed_triangles = scene.placed.triangle_count();
  asked->work.mesh_triangles = mesh_triangles_;
  if (!asked->may_place()) return true;
  return asked->refused(*side) == kInvalidId &&
         chosen_.value_or(asked->by_world || scene.placed.is_waiting() || !asked->flat.is_whole() ||
                          asked->work.has_many(side->costs));
}

template <class Trees>
bool SceneLevels::enter_all(const Asked& asked, const Trees& trees, Side* side) {
  const View<const PlacedInstance> instances = asked.scene.placed.instances();
  entered_.assign(instances.size, 1);
  entered_count_ = instances.size;
  if (!asked.may_place() || chosen_ || asked.by_world) return true;
  LevelWork work = asked.work;
  bool builds = asked.flat.is_new(asked.scene);
  for (std::size_t i = 0; i < instances.size; ++i) {
    if (!asked.waits(i)) continue;
    work.moved_triangles += instances[i].triangle_count;
    builds = builds || !asked.flat.holds(i);
  }
  if (builds) work.new_triangles = work.placed_triangles, work.moved_triangles = 0;
  if (side->settled != asked.scene.version()) {
    work.missing_triangles = trees.missing_triangles(instances);
    work.instances = instances.size;
  }
  return side->plan.enters(work, side->since, side->costs);
}

bool SceneLevels::enter_part(const Asked& asked) {
  const SceneRuns& scene = asked.scene;
  const View<const PlacedInstance> instances = scene.placed.instances();
  const bool is_new = asked.flat.is_new(scene), has_many = asked.work.has_many(here_.costs);
  const bool is_same =
      std::exchange(structure_, scene.structure_version) == scene.structure_version;
  if (!is_same) since_.assign(instances.size, here_.plan.spent_ns());
  // 1: is entered, 2: is entered unless it has paid.
  entered_.assign(instances.size, 0);
  entered_count_ = 0;
  std::uint64_t may_be_placed = 0, waiting = 0;
  bool builds = is_new;
  double latest = 0;
  for (std::size_t begin = 0, end = 0; begin < instances.size; begin = end) {
    while (end < instances.size && instances[end].geom_id == instances[begin].geom_id) ++end;
    const bool is_crowd = has_many && end - begin >= kCrowd;
    for (std::size_t i = begin; i < end; ++i) {
      if (scene.notes[i].moved_at > position_) since_[i] = here_.plan.spent_ns();
      const bool waits = asked.waits(i);
      if ((asked.by_world && scene.notes[i].world != kAllWorlds) ||
          (asked.moves && instances[i].moves()) || (is_crowd && waits)) {
        entered_[i] = 1;
      } else {
        may_be_placed += instances[i].triangle_count;
        if (!waits) continue;
        entered_[i] = 2;
        waiting += instances[i].triangle_count;
        builds = builds || !asked.flat.holds(i);
        latest = std::max(latest, since_[i]);
      }
      ++entered_count_;
    }
  }
  position_ = scene.position_version;

  bool enters = false;
  double paid = 0;
  if (waiting != 0 && !chosen_) {
    const bool others_stand = !is_new && may_be_placed - waiting >= here_.costs.few_triangles;
    LevelWork work{.rays = asked.work.rays, .in_part = others_stand};
    (builds ? work.new_triangles : work.moved_triangles) = builds ? may_be_placed : waiting;
    if (here_.settled != scene.version()) {
      work.missing_triangles = levels_.missing_triangles(instances, entered_);
      work.instances = entered_count_;
    }
    paid = here_.plan.paid_since(work, here_.costs);
    enters = here_.plan.enters(work, latest, here_.costs);
  }
  for (std::size_t i = 0; i < instances.size; ++i) {
    if (entered_[i] != 2) continue;
    entered_[i] = enters && since_[i] > paid ? 1 : 0;
    if (entered_[i] != 0)
      may_be_placed -= instances[i].triangle_count;
    else
      --entered_count_;
  }
  const bool takes_all = chosen_.value_or(false) || !scene.placed.fits() ||
                         (entered_count_ != 0 && may_be_placed < here_.costs.few_triangles);
  if (takes_all) entered_.assign(instances.size, 1), entered_count_ = instances.size;
  return entered_count_ != 0;
}

template <class Trees>
bool SceneLevels::settle(const Asked& asked, Trees* trees, Side* side) {
  const SceneRuns& scene = asked.scene;
  constexpr bool kHere = std::is_same_v<Trees, Levels>;
  const bool is_settled = side->settled == scene.version() && (!kHere || settled_ == entered_);
  if (!is_settled && asked.refused(*side) == kInvalidId) {
    const Stopwatch watch;
    side->settled = 0;  // until all is done: memory may run out
    std::vector<std::uint32_t> members;
    std::vector<LevelMark> marks;
    for (std::uint32_t i = 0; i < entered_.size(); ++i) {
      if (entered_[i] == 0) continue;
      members.push_back(i);
      marks.push_back({scene.notes[i].mask, scene.notes[i].world});
    }
    if constexpr (kHere) {
      side->refuses_points = trees->update(asked.executor, scene.placed, marks, members);
      side->refuses_rays =
          side->refuses_points != kInvalidId ? side->refuses_points : trees->refuses_rays();
      settled_ = entered_;
    } else {
      side->refuses_rays = trees->set_instances(asked.executor, scene.placed.instances(), marks);
    }
    if (asked.report != nullptr) asked.report->hierarchy_ms += watch.ms();
    if (side->refuses_points == kInvalidId) side->settled = scene.version();
  }
  const InstanceId refused = asked.refused(*side);
  if (refused == kInvalidId) {
    if (asked.report != nullptr) explain(asked);
    return true;
  }
  if (asked.may_place()) return false;
  const std::string why =
      asked.moves ? "no ray with a time can enter it, because its entries are too large"
      : asked.of_points()
          ? "no point can enter it, because its entries are too large"
          : "no ray can enter it, because it is singular, squeezes by more than about 1 : "
            "10 000, or leads where float32 moves corners";
  throw Error(
      ErrorCode::kUnsupported,
      scene.placed.fits() ? why : why + "; it cannot be placed either: " + counted_triangles(scene),
      "instances[" + std::to_string(refused) + "].transform");
}

void SceneLevels::explain(const Asked& asked) const {
  const PlacedRuns& placed = asked.scene.placed;
  std::uint64_t triangles = 0;
  for (std::size_t i = 0; i < entered_.size(); ++i)
    if (entered_[i] != 0) triangles += placed.instances()[i].triangle_count;
  const std::string who = asked.of_points() ? "points" : "rays";
  std::string sentence =
      "instances: entered by the " + who + " where they stand, because " +
      (asked.moves      ? "rays have times"
       : asked.by_world ? who + " in one world see few of them"
       : !placed.fits() ? std::to_string(triangles) + " triangles cannot be placed"
       : asked.work.has_many(here_.costs)
           ? std::to_string(triangles) + " placed triangles would take much memory"
           : std::to_string(asked.work.rays + asked.work.points) + " " + who +
                 " do not pay for placing " + std::to_string(triangles) + " triangles");
  if (entered_count_ != entered_.size()) {
    const std::uint64_t others = placed.triangle_count() - triangles;
    sentence += "; the others, " + std::to_string(others) + " triangles, are placed";
  }
  asked.report->plan.push_back(std::move(sentence));
}

Entered SceneLevels::for_query(const Executor& executor, const SceneRuns& scene,
                               const SceneView& flat, const LevelWork& work,
                               const ItemWorlds& worlds, bool in_time, QueryReport* report) {
  const std::scoped_lock lock(mutex_, scene.placing);
  if (in_time && std::exchange(looked_, scene.version()) != scene.version())
    moves_ = std::ranges::any_of(scene.placed.instances(), &PlacedInstance::moves);
  const bool by_world = scene.has_worlds && worlds.are_given(), moves = in_time && moves_;
  Asked asked{executor, scene, flat, work, by_world, moves, report};
  if (!look(&asked, &here_) ||
      !(asked.of_points() ? enter_all(asked, levels_, &here_) : enter_part(asked)) ||
      !settle(asked, &levels_, &here_))
    return {};
  const Stopwatch watch;
  if (by_world) levels_.update_forest(executor, moves);
  if (!by_world || are_in_all(worlds, work.rays + work.points)) levels_.update_top(executor, moves);
  if (report != nullptr) report->hierarchy_ms += watch.ms();
  if (entered_count_ == entered_.size()) return {&levels_};
  return {&levels_, View<const std::uint8_t>(entered_)};
}

bool SceneLevels::on_device(const Executor& executor, const SceneRuns& scene, const SceneView& flat,
                            std::uint64_t rays, DeviceQueries* engine, QueryReport* report) {
  const std::scoped_lock lock(mutex_, scene.placing);
  Asked asked{executor, scene, flat, {.rays = rays}, false, false, report};
  return look(&asked, &there_) && enter_all(asked, *engine, &there_) &&
         settle(asked, engine, &there_);
}

void SceneLevels::choose(std::optional<bool> enter) {
  const std::lock_guard lock(mutex_);
  chosen_ = enter;
}

std::size_t SceneLevels::memory_bytes() {
  const std::lock_guard lock(mutex_);
  return levels_.memory_bytes() + entered_.capacity() + settled_.capacity() +
         since_.capacity() * sizeof(double);
}

}  // namespace raysheaf
