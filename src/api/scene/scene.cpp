// Implements the public scene: every call passes the gate, and reports errors as `Error`.
#include "raysheaf/scene.h"

#include "api/scene/scene_impl.h"
#include "exec/stopwatch.h"
#include "scene/motion.h"

namespace raysheaf {
namespace {

/// Calls `body(state)` with exclusive access; its time is added to the next commit's.
template <class Body>
auto change(Scene& scene, const Body& body) {
  auto& state = SceneAccess::state(scene);
  const SceneGate::Changing alone(state.gate);
  struct Timer {
    double* sum;
    Stopwatch watch;
    ~Timer() { *sum += watch.lap_ms(); }
  } timer{&state.pending_ms, {}};
  return translated([&] { return body(state); });
}

template <class Body>
auto look(const Scene& scene, const Body& body) {
  auto& state = SceneAccess::state(scene);
  const SceneGate::Reading together(state.gate);
  return translated([&] { return body(state); });
}

template <class T>
View<const T> view(std::span<const T> span) {
  return {span.data(), span.size()};
}

}  // namespace

Affine transform_at(std::span<const Affine> transforms, float time) {
  return affine_at(view(transforms), time);
}

Scene::Scene(const Context& context)
    : impl_(translated([&] { return std::make_unique<Impl>(context); })) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

MeshId Scene::add(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                  const MeshOptions& options) {
  const View<const Triangle> indices = view(triangles);
  return change(*this, [&](Impl& s) { return s.add(view(positions), &indices, options); });
}
MeshId Scene::add_soup(std::span<const Vec3> positions, const MeshOptions& options) {
  return change(*this, [&](Impl& s) { return s.add(view(positions), nullptr, options); });
}
void Scene::replace(MeshId mesh, std::span<const Vec3> positions,
                    std::span<const Triangle> triangles) {
  const View<const Triangle> indices = view(triangles);
  change(*this, [&](Impl& s) { s.replace(mesh, view(positions), &indices); });
}
void Scene::replace_soup(MeshId mesh, std::span<const Vec3> positions) {
  change(*this, [&](Impl& s) { s.replace(mesh, view(positions), nullptr); });
}
void Scene::update(MeshId mesh, std::span<const Vec3> positions) {
  update(mesh, positions, 1);
}
void Scene::update(MeshId mesh, std::span<const Vec3> begin, std::span<const Vec3> end) {
  const std::array times{view(begin), view(end)};
  change(*this, [&](Impl& s) { s.update(mesh, {times.data(), times.size()}); });
}
void Scene::update(MeshId mesh, std::span<const Vec3> positions, std::size_t times) {
  if (times == 0 || positions.size() % times != 0)
    throw Error(
        ErrorCode::kInvalidArgument,
        std::to_string(positions.size()) + " positions for " + std::to_string(times) + " times",
        "positions");
  const std::size_t each = positions.size() / times;
  change(*this, [&](Impl& s) {
    std::vector<View<const Vec3>> all(times);
    for (std::size_t k = 0; k < times; ++k) all[k] = view(positions).slice(k * each, each);
    s.update(mesh, View<const View<const Vec3>>(all));
  });
}
void Scene::remove(MeshId mesh) {
  change(*this, [&](Impl& s) { s.remove(mesh); });
}

InstanceId Scene::instance(MeshId mesh, const Affine& transform, std::uint32_t mask,
                           WorldId world) {
  return instances(mesh, {&transform, 1}, {&world, 1}, mask);
}
InstanceId Scene::instances(MeshId mesh, std::span<const Affine> transforms,
                            std::span<const WorldId> worlds, std::uint32_t mask) {
  return change(*this,
                [&](Impl& s) { return s.instances(mesh, view(transforms), view(worlds), mask); });
}
void Scene::remove_instance(InstanceId instance) {
  change(*this, [&](Impl& s) { s.remove_instance(instance); });
}
void Scene::set_transform(InstanceId instance, const Affine& transform) {
  set_transforms({&instance, 1}, {&transform, 1});
}
void Scene::set_transform(InstanceId instance, const Affine& begin, const Affine& end) {
  set_transforms({&instance, 1}, std::array{begin, end}, 2);
}
void Scene::set_transforms(std::span<const InstanceId> instances,
                           std::span<const Affine> transforms, std::size_t each) {
  change(*this, [&](Impl& s) { s.set_transforms(view(instances), view(transforms), each); });
}
void Scene::set_mask(InstanceId instance, std::uint32_t mask) {
  change(*this, [&](Impl& s) { s.set_mask(instance, mask); });
}
void Scene::set_world(InstanceId instance, WorldId world) {
  change(*this, [&](Impl& s) { s.set_world(instance, world); });
}

void Scene::commit() {
  Impl& s = SceneAccess::state(*this);
  const SceneGate::Changing alone(s.gate);
  if (s.committed) return;
  Stopwatch watch;
  translated([&] { s.commit(); });
  s.update_ms = s.pending_ms + watch.lap_ms();
  s.pending_ms = 0;
}
bool Scene::is_committed() const {
  return look(*this, [](const Impl& s) { return s.committed; });
}

const Context& Scene::context() const {
  return SceneAccess::state(*this).context;
}
bool Scene::has_mesh(MeshId mesh) const {
  return look(*this, [&](const Impl& s) { return s.meshes.contains(mesh); });
}
bool Scene::has_instance(InstanceId instance) const {
  return look(*this, [&](const Impl& s) { return s.placements.contains(instance); });
}
std::vector<MeshId> Scene::meshes() const {
  return look(*this, [](const Impl& s) {
    std::vector<MeshId> all;
    for (const auto& [id, mesh] : s.meshes) all.push_back(id);
    return all;
  });
}
std::vector<InstanceId> Scene::instances(MeshId mesh) const {
  return look(*this, [&](const Impl& s) {
    std::vector<InstanceId> all;
    for (const Placement* placement : s.mesh(mesh).instances) all.push_back(placement->id);
    return all;
  });
}
MeshId Scene::mesh_of(InstanceId instance) const {
  return look(*this, [&](const Impl& s) { return s.placement(instance).mesh->id; });
}
Affine Scene::transform(InstanceId instance) const {
  return look(*this, [&](const Impl& s) { return s.placement(instance).to_world; });
}
std::vector<Affine> Scene::transforms(InstanceId instance) const {
  return look(*this, [&](const Impl& s) {
    const Placement& placement = s.placement(instance);
    return placement.motion.empty() ? std::vector<Affine>{placement.to_world} : placement.motion;
  });
}
std::uint32_t Scene::mask(InstanceId instance) const {
  return look(*this, [&](const Impl& s) { return s.placement(instance).mask; });
}
WorldId Scene::world(InstanceId instance) const {
  return look(*this, [&](const Impl& s) { return s.placement(instance).world; });
}

std::size_t Scene::mesh_count() const {
  return look(*this, [](const Impl& s) { return s.meshes.size(); });
}
std::size_t Scene::instance_count() const {
  return look(*this, [](const Impl& s) { return s.placements.size(); });
}
std::size_t Scene::vertex_count(MeshId mesh) const {
  return look(*this, [&](const Impl& s) { return s.mesh(mesh).arrays.positions().size; });
}
std::size_t Scene::triangle_count(MeshId mesh) const {
  return look(*this,
              [&](const Impl& s) { return std::size_t{s.mesh(mesh).arrays.triangle_count()}; });
}
std::uint64_t Scene::triangle_count() const {
  return look(*this, [](const Impl& s) {
    std::uint64_t count = 0;
    for (const auto& [id, mesh] : s.meshes)
      count += std::uint64_t{mesh.arrays.triangle_count()} * mesh.instances.size();
    return count;
  });
}
Box Scene::bounds() const {
  return look(*this, [](Impl& s) { return s.bounds(); });
}
std::size_t Scene::memory_bytes() const {
  return look(*this, [](Impl& s) { return s.memory_bytes(); });
}

}  // namespace raysheaf
