// Applies the changes of a scene to what queries see.
#include <algorithm>
#include <atomic>
#include <mutex>

#include "api/scene/scene_impl.h"
#include "api/scene/scene_transform.h"
#include "base/vec.h"
#include "scene/mirrors.h"

namespace raysheaf {
namespace {

constexpr std::uint64_t kMostTriangles = 0x7fffffff;

struct Move {
  const Placement* placement;
  std::size_t first;  // of its vertices, counted over all moves
  View<const Vec3> from;
  const Affine* to_world;
  Vec3* to;
};

/// Whether a vertex that a triangle uses leaves the valid range.
bool leaves_range(const Executor& executor, const Move& move) {
  return !move.placement->mesh->arrays.corners_are_right(executor, {move.to, move.from.size});
}

/// The smallest instance that leaves the range, or kInvalidId. Tasks may span several instances,
/// and instances several tasks.
InstanceId run_moves(const Executor& executor, const std::vector<Move>& moves, std::size_t count) {
  std::vector<std::uint8_t> is_doubtful(moves.size());
  executor.for_each_block(count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    const auto after =
        std::upper_bound(moves.begin(), moves.end(), begin,
                         [](std::size_t vertex, const Move& move) { return vertex < move.first; });
    for (auto move = after - 1; begin < end; ++move) {
      const std::size_t first = begin - move->first;
      const std::size_t stop = std::min(end - move->first, move->from.size);
      begin = move->first + stop;
      if (transform_points(*move->to_world, move->from.data + first, stop - first,
                           move->to + first))
        continue;
      std::atomic_ref(is_doubtful[static_cast<std::size_t>(move - moves.begin())])
          .store(1, std::memory_order_relaxed);
    }
  });
  InstanceId refused = kInvalidId;
  for (std::size_t m = 0; m < moves.size(); ++m)
    if (is_doubtful[m] != 0 && moves[m].placement->id < refused && leaves_range(executor, moves[m]))
      refused = moves[m].placement->id;
  return refused;
}

Box box_of(const Executor& executor, const std::vector<SceneRun>& runs) {
  Box box;
  std::mutex mutex;
  for (const SceneRun& scene_run : runs) {
    const TriangleRun& run = scene_run.triangles;
    executor.for_each_block(run.count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
      Box part;
      for (std::size_t i = begin; i < end; ++i) {
        for (const Vec3 corner : run.corners(static_cast<std::uint32_t>(i))) {
          part.min = min(part.min, corner);
          part.max = max(part.max, corner);
        }
      }
      const std::lock_guard lock(mutex);
      box.min = min(box.min, part.min);
      box.max = max(box.max, part.max);
    });
  }
  // Adding 0 turns -0 into +0. Which of the two the box gets would depend on the order of the
  // tasks.
  box.min += {0, 0, 0};
  box.max += {0, 0, 0};
  return box;
}

}  // namespace

void Scene::Impl::commit() {
  if (committed) return;
  const std::vector<Placement*> moved = moved_placements();
  move_to_world(moved);
  if (structure_changed_) {
    list_runs();
    ++runs.structure_version;
  } else {
    move_runs(moved);
  }
  if (!moved.empty()) ++runs.position_version;
  if (structure_changed_ || masks_changed_) {
    list_masks();
    ++runs.mask_version;
    views.forget_old_masks(runs);
  }
  for (Placement* placement : moved) placement->stale = false;
  stale_.clear();
  structure_changed_ = masks_changed_ = false;
  bounds_.reset();
  committed = true;
}

/// Those of `stale_` that still exist.
std::vector<Placement*> Scene::Impl::moved_placements() {
  std::vector<Placement*> moved;
  moved.reserve(stale_.size());
  for (const InstanceId id : stale_) {
    const auto found = placements.find(id);
    if (found != placements.end()) moved.push_back(&found->second);
  }
  return moved;
}

/// Computes world positions of the instances that have moved, unless they share those of their
/// mesh.
void Scene::Impl::move_to_world(const std::vector<Placement*>& moved) {
  std::vector<Move> moves;
  std::size_t count = 0;
  for (Placement* placement : moved) {
    const View<const Vec3> from = placement->mesh->arrays.positions();
    if (placement->is_identity || from.empty()) continue;
    placement->world.resize_uninitialized(from.size);
    moves.push_back({placement, count, from, &placement->to_world, placement->world.data()});
    count += from.size;
  }
  const InstanceId refused = run_moves(executor(), moves, count);
  if (refused == kInvalidId) return;
  throw Error(ErrorCode::kInvalidData,
              "the transform puts a vertex of meshes[" +
                  std::to_string(placement(refused).mesh->id) + "] farther out than 1e18",
              "instances[" + std::to_string(refused) + "].transform");
}

/// Makes all runs again, sorted by (mesh, instance). If there are too many, the old ones stay.
void Scene::Impl::list_runs() {
  std::uint64_t count = 0;
  for (const auto& [id, mesh] : meshes)
    count += std::uint64_t{mesh.arrays.triangle_count()} * mesh.instances.size();
  if (count > kMostTriangles)
    throw Error(
        ErrorCode::kUnsupported,
        "its instances have " + std::to_string(count) + " triangles in all, more than 2^31 - 1",
        "scene");
  runs.runs.reserve(placements.size());
  runs.runs.clear();
  std::uint32_t first = 0;
  for (const auto& [id, mesh] : meshes) {
    const MeshArrays& arrays = mesh.arrays;
    for (Placement* placement : mesh.instances) {
      placement->run = Placement::kNoRun;
      if (arrays.triangle_count() == 0) continue;
      placement->run = runs.runs.size();
      runs.runs.push_back(
          {{placement->positions(), arrays.triangles(), first, arrays.triangle_count()},
           id,
           placement->id,
           placement->mask,
           0,
           mirrors(placement->to_world)});
      first += arrays.triangle_count();
    }
  }
  runs.triangle_count = count;
}

/// Updates the positions of the same runs.
void Scene::Impl::move_runs(const std::vector<Placement*>& moved) {
  for (const Placement* placement : moved) {
    if (placement->run == Placement::kNoRun) continue;
    SceneRun& run = runs.runs[placement->run];
    run.triangles.positions = placement->positions();
    run.mirrored = mirrors(placement->to_world);
    run.moved_at = runs.position_version + 1;
  }
}

void Scene::Impl::list_masks() {
  runs.masks.clear();
  for (SceneRun& run : runs.runs) {
    run.mask = placements.at(run.instance).mask;
    // Usually there are few distinct masks.
    if (runs.masks.empty() || runs.masks.back() != run.mask) runs.masks.push_back(run.mask);
  }
  std::sort(runs.masks.begin(), runs.masks.end());
  runs.masks.erase(std::unique(runs.masks.begin(), runs.masks.end()), runs.masks.end());
}

void Scene::Impl::require_committed() const {
  if (!committed)
    throw Error(ErrorCode::kWrongState, "the scene has changes that wait for commit()", "scene");
}

Box Scene::Impl::bounds() {
  require_committed();
  Box box;
  executor().enter([&] {
    const std::lock_guard lock(bounds_mutex_);
    if (!bounds_) bounds_ = box_of(executor().alone(), runs.runs);
    box = *bounds_;
  });
  return box;
}

std::size_t Scene::Impl::memory_bytes() {
  std::size_t bytes = views.memory_bytes() + runs.runs.capacity() * sizeof(SceneRun);
  for (const auto& [id, mesh] : meshes)
    bytes += sizeof(mesh) + mesh.arrays.memory_bytes() + mesh.instances.capacity() * sizeof(void*);
  for (const auto& [id, placement] : placements)
    bytes += sizeof(placement) + placement.world.capacity_bytes();
  return bytes;
}

}  // namespace raysheaf
