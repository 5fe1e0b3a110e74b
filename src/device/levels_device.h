// Instances that rays enter where they stand, in a device's memory. For sources that include a
// device.
//
//   meshes that are new ─► corners ─► a tree each (object_tree/linear_tree.h)
//   transforms ─► placings and boxes, computed on the device ─► the tree over instances: built,
//                                                               refitted or kept
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "device/level_walk_body.h"
#include "device/tree_device.h"
#include "device/triangles_device.h"
#include "levels/level_scene.h"
#include "raysheaf/scene.h"
#include "scene/placed_runs.h"

namespace raysheaf {

template <class Device>
class DeviceLevels {
 public:
  explicit DeviceLevels(Device& device) : device_(device) {}

  /// As `DeviceQueries` has them.
  [[nodiscard]] std::uint64_t missing_triangles(View<const PlacedInstance> instances) const {
    std::uint64_t missing = 0;
    for (std::size_t i = 0; i < instances.size; ++i) {
      if (!begins_mesh(instances, i)) continue;
      const auto kept = meshes_.find(instances[i].geom_id);
      if (kept == meshes_.end() || kept->second.shape != instances[i].shape)
        missing += instances[i].triangle_count;
    }
    return missing;
  }
  InstanceId set(const Executor& executor, View<const PlacedInstance> instances,
                 View<const LevelMark> marks) {
    std::vector<InstanceNote> notes;
    std::vector<Affine> to_world;
    std::vector<DeviceMesh> meshes;
    std::map<std::uint32_t, Mesh> former = std::exchange(meshes_, {});
    bool are_same = true;
    for (std::size_t i = 0; i < instances.size; ++i) {
      const PlacedInstance& instance = instances[i];
      if (begins_mesh(instances, i)) {
        are_same = keep_or_build(executor, instance, &former) && are_same;
        const LinearTree& tree = meshes_.at(instance.geom_id).tree;
        meshes.push_back({tree.view(), tree.scene()});
      }
      const auto mesh = static_cast<std::uint32_t>(meshes.size() - 1);
      notes.push_back({mesh, instance.geom_id, instance.inst_id, marks[i].mask});
      to_world.push_back(instance.to_world);
    }
    are_same = are_same && notes == notes_;
    notes_.clear();  // until all is done: memory may run out
    top_.forget(are_same);
    if (!are_same) {
      upload(device_, "copy: instances", View<const DeviceMesh>(meshes), &mesh_places_);
      upload(device_, "copy: instances", View<const InstanceNote>(notes), &notes_there_);
    }
    upload(device_, "copy: instances", View<const Affine>(to_world), &to_world_);
    const InstanceId refused = stand(notes.size());
    notes_ = std::move(notes);
    return refused;
  }

  /// Brings the tree over instances to where they stand; returns how.
  TreeWork prepare() { return top_.prepare({corners_.view_const(), {}}); }
  void learn_cost() { top_.learn_cost(); }
  [[nodiscard]] const DeviceTree<Device>& top() const { return top_; }
  [[nodiscard]] const DeviceInstance* instances() const { return instances_.data(); }
  [[nodiscard]] std::size_t memory_bytes() const {
    std::size_t bytes = corners_of_mesh_.memory_bytes() + mesh_places_.capacity_bytes() +
                        notes_there_.capacity_bytes() + to_world_.capacity_bytes() +
                        instances_.capacity_bytes() + corners_.capacity_bytes() +
                        refused_.capacity_bytes() + top_.memory_bytes();
    for (const auto& [id, mesh] : meshes_) bytes += mesh.tree.memory_bytes();
    return bytes;
  }

  /// Public only because nvcc requires it for device loops. Fills `instances_`, and the corners of
  /// their boxes.
  InstanceId stand(std::size_t count) {
    constexpr const char* kStage = "hierarchy: instances";
    instances_.resize_uninitialized(kStage, count);
    corners_.resize_uninitialized(kStage, 3 * count);
    refused_.resize_uninitialized(kStage, 1);
    device_.fill(kStage, refused_.view(), 0xff);
    const DeviceMesh* const meshes = mesh_places_.data();
    const InstanceNote* const notes = notes_there_.data();
    const Affine* const to_world = to_world_.data();
    DeviceInstance* const instances = instances_.data();
    Vec3* const corners = corners_.data();
    std::uint32_t* const refused = refused_.data();
    device_.for_each(kStage, count, [=] RAYSHEAF_DEVICE(std::size_t i) {
      const InstanceNote note = notes[i];
      const DeviceInstance instance = make_instance(to_world[i], meshes[note.mesh], note);
      const Box box = world_box(instance);
      instances[i] = instance;
      corners[3 * i] = box.min;
      corners[3 * i + 1] = corners[3 * i + 2] = box.max;
      if (!instance.placing.may_enter || !instance.placing.has_boxes)
        lower_to(refused, note.inst_id);
    });
    return device_.read(kStage, refused_.data());
  }

 private:
  struct Mesh {
    explicit Mesh(DeviceAllocator& allocator) : tree(allocator) {}
    std::uint64_t shape = 0;
    LinearTree tree;
  };

  /// Instances are sorted by mesh.
  [[nodiscard]] static bool begins_mesh(View<const PlacedInstance> instances, std::size_t i) {
    return i == 0 || instances[i].geom_id != instances[i - 1].geom_id;
  }
  /// The tree of the instance's mesh; returns whether it was kept.
  bool keep_or_build(const Executor& executor, const PlacedInstance& instance,
                     std::map<std::uint32_t, Mesh>* former) {
    if (const auto kept = former->find(instance.geom_id);
        kept != former->end() && kept->second.shape == instance.shape) {
      meshes_.insert(former->extract(kept));
      return true;
    }
    Mesh mesh(device_.allocator());
    const TriangleRun run{instance.positions.data, instance.triangles, 0, instance.triangle_count};
    corners_of_mesh_.set(executor, {View<const TriangleRun>(&run, 1), instance.triangle_count});
    mesh.tree.build(device_, corners_of_mesh_.list());
    mesh.shape = instance.shape;
    meshes_.emplace(instance.geom_id, std::move(mesh));
    return false;
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceTriangles<Device> corners_of_mesh_{device_};  ///< while its tree is built
  std::map<std::uint32_t, Mesh> meshes_;              ///< by geom_id
  std::vector<InstanceNote> notes_;                   ///< those on the device
  DeviceBuffer<DeviceMesh> mesh_places_{memory_};
  DeviceBuffer<InstanceNote> notes_there_{memory_};
  DeviceBuffer<Affine> to_world_{memory_};
  DeviceBuffer<DeviceInstance> instances_{memory_};
  DeviceBuffer<Vec3> corners_{memory_};  ///< of their boxes: least, greatest, greatest
  DeviceBuffer<std::uint32_t> refused_{memory_};
  DeviceTree<Device> top_{device_};
};

}  // namespace raysheaf
