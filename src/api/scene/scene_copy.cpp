// The arrays of a scene, its copy, and its ids given again.
#include <algorithm>

#include "api/scene/scene_impl.h"
#include "scene/motion.h"

namespace raysheaf {
namespace {

template <class Body>
auto read(const Scene& scene, const Body& body) {
  auto& state = SceneAccess::state(scene);
  const SceneGate::Reading together(state.gate);
  return translated([&] { return body(static_cast<const SceneAccess::State&>(state)); });
}

std::vector<const Placement*> placements_by_id(const SceneAccess::State& state) {
  std::vector<const Placement*> all;
  all.reserve(state.placements.size());
  for (const auto& [id, placement] : state.placements) all.push_back(&placement);
  std::ranges::sort(all, {}, &Placement::id);
  return all;
}

}  // namespace

std::size_t Scene::time_count(MeshId mesh) const {
  return read(*this, [&](const Impl& s) { return s.mesh(mesh).arrays.times().size; });
}

std::span<const Vec3> Scene::positions(MeshId mesh, std::size_t time) const {
  return read(*this, [&](const Impl& s) {
    const View<const View<const Vec3>> times = s.mesh(mesh).arrays.times();
    if (time >= times.size)
      throw Error(ErrorCode::kInvalidArgument,
                  "the mesh has positions at " + std::to_string(times.size) + " times",
                  "meshes[" + std::to_string(mesh) + "].times[" + std::to_string(time) + "]");
    return std::span<const Vec3>(times[time].data, times[time].size);
  });
}

std::vector<Vec3> Scene::positions_at(MeshId mesh, float time) const {
  if (!(time >= 0 && time <= 1))
    throw Error(ErrorCode::kInvalidArgument, "the time is not from 0 to 1", "time");
  return read(*this, [&](const Impl& s) {
    const View<const View<const Vec3>> times = s.mesh(mesh).arrays.times();
    const Instant at(time, times.size);
    std::vector<Vec3> there(times[0].size);
    for (std::size_t i = 0; i < there.size(); ++i)
      there[i] = at.mixed(times[at.before][i], times[at.after][i]);
    return there;
  });
}

std::span<const Triangle> Scene::triangles(MeshId mesh) const {
  return read(*this, [&](const Impl& s) {
    const MeshArrays& arrays = s.mesh(mesh).arrays;
    if (arrays.triangles() == nullptr) return std::span<const Triangle>();
    return std::span<const Triangle>(arrays.triangles(), arrays.triangle_count());
  });
}

bool Scene::is_soup(MeshId mesh) const {
  return read(*this, [&](const Impl& s) { return s.mesh(mesh).arrays.is_soup(); });
}

MeshId Scene::next_mesh() const {
  return read(*this, [](const Impl& s) { return s.next_mesh(); });
}

InstanceId Scene::next_instance() const {
  return read(*this, [](const Impl& s) { return s.next_instance(); });
}

void Scene::continue_ids(MeshId next_mesh, InstanceId next_instance) {
  auto& state = SceneAccess::state(*this);
  const SceneGate::Changing alone(state.gate);
  state.continue_ids(next_mesh, next_instance);
}

void Scene::Impl::continue_ids(MeshId next_mesh, InstanceId next_instance) {
  if (next_mesh < next_mesh_ || next_instance < next_instance_)
    throw Error(ErrorCode::kInvalidArgument,
                "ids that were given out before cannot be given out again", "scene");
  next_mesh_ = next_mesh;
  next_instance_ = next_instance;
}

Scene Scene::copy() const {
  return read(*this, [](const Impl& s) {
    Scene other(s.context);
    for (const auto& [id, mesh] : s.meshes) {
      const View<const Vec3> positions = mesh.arrays.positions();
      other.continue_ids(id, 0);
      if (mesh.arrays.is_soup())
        other.add_soup({positions.data, positions.size}, {.place = false});
      else
        other.add({positions.data, positions.size},
                  {mesh.arrays.triangles(), mesh.arrays.triangle_count()}, {.place = false});
      if (mesh.arrays.times().size > 1) SceneAccess::state(other).update(id, mesh.arrays.times());
    }
    for (const Placement* placement : placements_by_id(s)) {
      other.continue_ids(other.next_mesh(), placement->id);
      other.instance(placement->mesh->id, placement->to_world, placement->mask, placement->world);
      if (!placement->motion.empty())
        other.set_transforms({&placement->id, 1}, placement->motion, placement->motion.size());
    }
    other.continue_ids(s.next_mesh(), s.next_instance());
    if (s.committed) other.commit();
    return other;
  });
}

}  // namespace raysheaf
