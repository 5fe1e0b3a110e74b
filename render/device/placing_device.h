// A scene in a device's memory. Where its instances move, a matrix each is sent; where meshes
// change their shape, weights and joints; and the device places the triangles. For the sources that
// know which device it is.
#pragma once

#include <bit>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "device/queries_device.h"
#include "render/device/place_loops_device.h"
#include "render/device/scene_device.h"
#include "render/device/shapes_device.h"

namespace raysheaf {

template <class Device>
class ScenePlacer {
 public:
  explicit ScenePlacer(Device& device) : device_(device) {}

  /// Another scene lies there from now on.
  void forget() {
    knows_ = false;
    shapes_.clear();
  }

  /// As `DeviceStages::place` has it; `corners` and `flags`: all triangles'. Vertices and
  /// all matrices are sent once, the first time.
  [[nodiscard]] std::optional<Box> place(const FlatScene& scene, View<const std::uint32_t> places,
                                         View<const MeshPose> poses,
                                         SceneOnDevice<Device>* surfaces, View<Vec3> corners,
                                         View<std::uint8_t> flags) {
    if (!knows_) send_rest(scene);
    bounds_.resize_uninitialized("scene: place", 1);
    device_.fill("scene: place", bounds_.view(), 0xff);
    for (const MeshPose& pose : poses) deform(scene, pose, surfaces);
    std::vector<MovedMesh> moved;
    for (const std::uint32_t place : places)
      moved.push_back({place, to_world(scene, scene.meshes[place])});
    upload(device_, View<const MovedMesh>(moved), &moved_);
    move_meshes_on(device_, moved_.view_const(), to_world_.data(), surfaces->meshes());
    place_triangles_on(device_, surfaces->view({corners.data, corners.size}),
                       {positions_.data(), to_world_.data(), corners, flags}, bounds_.data());
    const PlacedBounds bounds = device_.read("scene: place", bounds_.data());
    if (bounds.refused != kInvalidId) return std::nullopt;
    Box box = box_of(bounds.box);
    box.min += {0, 0, 0};  // as the host has them, without -0
    box.max += {0, 0, 0};
    return box;
  }

  /// As `DeviceStages::shape_bounds` has it.
  [[nodiscard]] std::vector<Sphere> bound(const FlatScene& scene, View<const std::uint32_t> meshes,
                                          const SceneOnDevice<Device>& surfaces) {
    reaches_.resize_uninitialized("scene: bound", meshes.size);
    device_.fill("scene: bound", reaches_.view(), 0xff);
    for (std::size_t i = 0; i < meshes.size; ++i) {
      const FirstPlaces& first = first_[meshes[i]];
      const std::size_t count = scene.description->meshes[meshes[i]].triangles.size();
      bound_shape_on(device_, surfaces.triangles().slice(first.triangle, count),
                     positions_.data() + first.position, reaches_.data() + i);
    }
    std::vector<ShapeReach> reaches(meshes.size);
    device_.copy("scene: bound", reaches.data(), reaches_.data(),
                 reaches.size() * sizeof(ShapeReach));
    std::vector<Sphere> spheres(meshes.size);
    for (std::size_t i = 0; i < meshes.size; ++i)
      if (!scene.description->meshes[meshes[i]].triangles.empty())
        spheres[i] = shape_sphere(shape_center(box_of(reaches[i].box)),
                                  std::bit_cast<double>(~reaches[i].farthest));
    return spheres;
  }

 private:
  static const Affine& to_world(const FlatScene& scene, const FlatMesh& mesh) {
    return scene.description->instances[mesh.inst_id].to_world;
  }

  void deform(const FlatScene& scene, const MeshPose& pose, SceneOnDevice<Device>* surfaces) {
    const Mesh& mesh = scene.description->meshes[pose.shape->mesh];
    std::unique_ptr<ShapeThere<Device>>& shape = shapes_[pose.shape];
    if (shape == nullptr) shape = std::make_unique<ShapeThere<Device>>(device_, *pose.shape, mesh);
    const FirstPlaces& first = first_[pose.shape->mesh];
    const VerticesThere out{positions_.data() + first.position,
                            mesh.normals.empty() ? nullptr : surfaces->normals() + first.normal};
    shape->take(device_, pose, out, &bounds_.data()->refused);
  }

  void send_rest(const FlatScene& scene) {
    std::vector<Vec3> positions;
    first_.clear();
    std::size_t normals = 0, triangles = 0;
    for (const Mesh& mesh : scene.description->meshes) {
      first_.push_back({positions.size(), normals, triangles});
      positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
      normals += mesh.normals.size();
      triangles += mesh.triangles.size();
    }
    std::vector<Affine> to_worlds;
    for (const FlatMesh& mesh : scene.meshes) to_worlds.push_back(to_world(scene, mesh));
    upload(device_, View<const Vec3>(positions), &positions_);
    upload(device_, View<const Affine>(to_worlds), &to_world_);
    device_.synchronize("copy: scene");
    knows_ = true;
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  struct FirstPlaces {
    std::size_t position = 0, normal = 0, triangle = 0;
  };
  std::vector<FirstPlaces> first_;         ///< of each mesh
  DeviceBuffer<Vec3> positions_{memory_};  ///< of the meshes' vertices
  DeviceBuffer<Affine> to_world_{memory_};
  DeviceBuffer<MovedMesh> moved_{memory_};
  DeviceBuffer<PlacedBounds> bounds_{memory_};
  DeviceBuffer<ShapeReach> reaches_{memory_};
  std::map<const RigShape*, std::unique_ptr<ShapeThere<Device>>> shapes_;
  bool knows_ = false;
};

/// A flat scene in a device's memory: triangles, what rays find them by, and surfaces.
template <class Device>
class SceneThere {
 public:
  /// Takes the arguments of the device.
  template <class... Args>
  explicit SceneThere(Args&&... args)
      : engine_(std::forward<Args>(args)...),
        surfaces_(engine_.device()),
        placer_(engine_.device()) {}

  void forget(const FlatUpdate& update) {
    flat_ = nullptr;
    if (update.everything) surfaces_.forget_looks();
    same_triangles_ = same_triangles_ && update.same_triangles;
  }

  void set(const Executor& executor, const FlatScene& scene, const TextureSet& textures,
           const EnvironmentView& environment) {
    flat_ = nullptr;
    placer_.forget();
    const StagedScene staged = stage_scene(scene);
    engine_.set_triangles(executor, scene.triangle_count, scene.flags.data(),
                          std::exchange(same_triangles_, false),
                          [&](std::size_t begin, std::size_t end, CornersOfOne* out) {
                            for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
                              const std::array<Vec3, 3> placed = scene.corners(i);
                              Vec3 corner[3] = {placed[0], placed[1], placed[2]};
                              collapse_flat(corner);
                              *out++ = {corner[0], corner[1], corner[2]};
                            }
                          });
    surfaces_.set_geometry(scene, staged);
    surfaces_.set_looks(staged, textures.table(), environment);
    same_triangles_ = true;
    flat_ = &scene;
  }

  [[nodiscard]] std::optional<Box> place(const FlatScene& scene, View<const std::uint32_t> places,
                                         View<const MeshPose> poses) {
    flat_ = nullptr;
    DeviceTriangles<Device>& moving = engine_.moving_triangles();
    const std::optional<Box> box =
        placer_.place(scene, places, poses, &surfaces_, moving.corners(), moving.flags());
    if (box) flat_ = &scene;
    return box;
  }

  [[nodiscard]] std::vector<Sphere> bound(const FlatScene& scene,
                                          View<const std::uint32_t> meshes) {
    return placer_.bound(scene, meshes, surfaces_);
  }

  [[nodiscard]] bool is_there() const { return flat_ != nullptr; }
  /// The host's side of it.
  [[nodiscard]] const FlatScene& flat() const { return *flat_; }
  [[nodiscard]] DeviceQueriesOn<Device>& engine() { return engine_; }
  [[nodiscard]] TriangleList triangles() const { return engine_.triangles(); }
  [[nodiscard]] StagedSceneView view() const { return surfaces_.view(triangles().corners); }
  [[nodiscard]] const EnvironmentView& environment() const { return surfaces_.environment(); }

 private:
  DeviceQueriesOn<Device> engine_;
  SceneOnDevice<Device> surfaces_;
  ScenePlacer<Device> placer_;
  const FlatScene* flat_ = nullptr;
  bool same_triangles_ = false;  ///< as the engine has, only moved
};

}  // namespace raysheaf
