#include "render/entered_scene.h"

#include <algorithm>
#include <utility>

#include "raysheaf/error.h"
#include "system/process.h"

namespace raysheaf {
namespace {

/// The memory of a placed triangle, with its part of a tree (docs/library.md).
constexpr std::uint64_t kPlacedBytes = 150;

/// The triangles that would have to be placed.
LevelWork placing_work(const SceneDescription& scene, const SceneChanges& unplaced) {
  LevelWork work;
  if (unplaced.everything || unplaced.other_meshes_from != kInvalidId ||
      unplaced.other_instances_from != kInvalidId) {
    work.new_triangles = scene.triangle_count();
    return work;
  }
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const auto is_in = [](const std::vector<std::uint32_t>& list, std::uint32_t one) {
      return std::binary_search(list.begin(), list.end(), one);
    };
    const std::uint32_t mesh = scene.instances[i].mesh;
    if (is_in(unplaced.moved, i) || is_in(unplaced.deformed, mesh))
      work.moved_triangles += scene.meshes[mesh].triangles.size();
  }
  return work;
}

bool is_within(const Box& box) {
  const Vec3 most = max(abs(box.min), abs(box.max));
  return max_component(most) <= kLargestCoordinate;
}

}  // namespace

bool is_too_large_to_place(const SceneDescription& scene) {
  const std::uint64_t count = scene.triangle_count();
  const std::uint64_t room = system::memory_bytes();
  return count > kMostFlatTriangles || (room != 0 && count > room / kPlacedBytes);
}

void EnteredScene::note(const SceneDescription& scene, const SceneChanges& changes) {
  if (changes.empty()) return;
  is_listed_ = is_settled_ = false;
  const std::size_t meshes = scene.meshes.size();
  const std::size_t other =
      changes.everything ? 0 : std::min<std::size_t>(changes.other_meshes_from, meshes);
  has_new_shapes_ = has_new_shapes_ || other < meshes || !changes.deformed.empty();
  shapes_.resize(meshes);
  for (std::size_t i = other; i < meshes; ++i)
    shapes_[i] = {++versions_, shape_flags(scene, scene.meshes[i])};
  for (const std::uint32_t mesh : changes.deformed) shapes_[mesh].version = ++versions_;
}

bool EnteredScene::enter(const Executor& executor, const SceneDescription& scene,
                         const SceneChanges& unplaced, bool is_new, std::uint64_t rays) {
  if (unplaced.empty()) return false;
  if (!is_listed_ || standing_.description != &scene) list_standing(scene, shapes_, &standing_);
  is_listed_ = true;
  const std::uint64_t triangles = scene.triangle_count();
  if (is_too_large_to_place(scene)) {
    reason_ = std::to_string(triangles) + " triangles are too many to be placed";
    if (settle(executor)) return true;
    if (refused_ == kInvalidId) return false;
    throw Error(
        ErrorCode::kUnsupported,
        "rays cannot enter the instance, because its transform has no good inverse or moves "
        "it too far out, and the scene's " +
            reason_,
        "instances[" + std::to_string(standing_.meshes[refused_].inst_id) + "].to_world");
  }
  LevelWork work = placing_work(scene, unplaced);
  const std::uint64_t waiting = work.new_triangles + work.moved_triangles;
  if (!is_settled_) {
    work.missing_triangles = levels_.missing_triangles(standing_.placed.instances());
    work.instances = standing_.meshes.size();
  }
  work.rays = rays;
  work.placed_triangles = triangles;
  for (const Mesh& mesh : scene.meshes) work.mesh_triangles += mesh.triangles.size();
  // Shapes that come and go are not worth a tree that later images would use.
  const LevelCosts costs;
  const bool wastes = std::exchange(has_new_shapes_, false) &&
                      costs.mesh_triangle * static_cast<double>(work.missing_triangles) >
                          costs.new_triangle * static_cast<double>(waiting);
  if (wastes || !plan_.enters(work, is_new)) return false;
  reason_ = work.has_many() ? std::to_string(triangles) + " placed triangles would take much memory"
                            : "about " + std::to_string(rays) + " rays do not pay for placing " +
                                  std::to_string(waiting) + " triangles";
  return settle(executor);
}

bool EnteredScene::settle(const Executor& executor) {
  if (is_settled_) return may_enter_;
  const std::vector<LevelMark> marks(standing_.meshes.size());
  refused_ = levels_.update(executor, standing_.placed, View<const LevelMark>(marks));
  if (refused_ == kInvalidId) refused_ = levels_.refuses_rays();
  may_enter_ = refused_ == kInvalidId;
  if (may_enter_) {
    levels_.update_top(executor);
    standing_.bounds = levels_.scene().top->bounds;
    may_enter_ = is_within(standing_.bounds);  // otherwise placing finds which vertex is outside
  }
  is_settled_ = true;
  return may_enter_;
}

}  // namespace raysheaf
