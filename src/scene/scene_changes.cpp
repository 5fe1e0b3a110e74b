#include "raysheaf/scene_changes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace raysheaf {
namespace {

void unite(std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  if (b.empty()) return;
  std::vector<std::uint32_t> both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  a = std::move(both);
}

}  // namespace

bool SceneChanges::empty() const {
  return !everything && moved.empty() && deformed.empty() && other_meshes_from == kInvalidId &&
         other_instances_from == kInvalidId;
}

void SceneChanges::add(const SceneChanges& later) {
  everything = everything || later.everything;
  other_meshes_from = std::min(other_meshes_from, later.other_meshes_from);
  other_instances_from = std::min(other_instances_from, later.other_instances_from);
  unite(moved, later.moved);
  unite(deformed, later.deformed);
  std::erase_if(posed, [&](const MeshPose& pose) {
    return std::binary_search(later.deformed.begin(), later.deformed.end(), pose.shape->mesh);
  });
  posed.insert(posed.end(), later.posed.begin(), later.posed.end());
  if (later.move_vertices) move_vertices = later.move_vertices;
  // Meshes and instances from there on are different, and there may be fewer of them.
  std::erase_if(moved, [&](std::uint32_t i) { return i >= other_instances_from; });
  std::erase_if(deformed, [&](std::uint32_t m) { return m >= other_meshes_from; });
  std::erase_if(posed, [&](const MeshPose& pose) { return pose.shape->mesh >= other_meshes_from; });
  if (!everything) return;
  SceneChanges all;
  all.everything = true;
  all.posed = std::move(posed);
  all.move_vertices = std::move(move_vertices);
  *this = std::move(all);
}

}  // namespace raysheaf
