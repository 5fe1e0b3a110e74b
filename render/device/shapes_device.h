// Meshes that change their shape, in a device's memory. Their vertices, targets and weights of
// joints lie there; the weights of targets and the transforms of joints are sent. For the sources
// that know which device it is.
#pragma once

#include <cstring>
#include <vector>

#include "animation/shape_body.h"
#include "raysheaf/rig.h"
#include "render/device/place_loops_device.h"
#include "render/device/scene_device.h"
#include "scene/mesh_bound_body.h"

namespace raysheaf {

/// Where a mesh's vertices lie.
struct VerticesThere {
  Vec3* positions = nullptr;
  Vec3* normals = nullptr;  ///< null: it has none
};

/// `shape`: in the device's memory. A vertex that the host would refuse lowers `refused`.
template <class Device>
void deform_vertices_on(Device& device, const ShapeView& shape, const VerticesThere& out,
                        std::uint32_t* refused) {
  device.for_each("scene: deform", shape.positions.size, [=] RAYSHEAF_DEVICE(std::size_t v) {
    deform_vertex(shape, v, out.positions, out.normals);
    const Vec3 at = out.positions[v];
    const bool fits = is_finite(at) && max_component(abs(at)) <= kLargestCoordinate &&
                      (out.normals == nullptr || is_finite(out.normals[v]));
    if (!fits) lower_to(refused, 0u);
  });
}

template <class Device>
void flatten_normals_on(Device& device, View<const StagedTriangle> triangles,
                        const VerticesThere& out, std::uint32_t* refused) {
  device.for_each("scene: deform", triangles.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const StagedTriangle& triangle = triangles.data[i];
    flatten_normals_of(triangle.vertex, out.positions, out.normals);
    if (!is_finite(out.normals[triangle.vertex[0]])) lower_to(refused, 0u);
  });
}

RAYSHEAF_HD inline std::uint64_t double_bits(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

/// What `shape_bound` (scene/flat_update.h) finds of a mesh. All bits set before.
struct ShapeReach {
  SharedBox box;
  std::uint64_t farthest;  ///< the largest squared distance from the box's centre, bits inverted
};

/// `triangles`: of the mesh. Fills `reach`.
template <class Device>
void bound_shape_on(Device& device, View<const StagedTriangle> triangles, const Vec3* positions,
                    ShapeReach* reach) {
  device.for_each("scene: bound", triangles.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const StagedTriangle& t = triangles.data[i];
    enlarge(&reach->box,
            triangle_box(positions[t.vertex[0]], positions[t.vertex[1]], positions[t.vertex[2]]));
  });
  device.for_each("scene: bound", triangles.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Vec3 center = shape_center(box_of(reach->box));
    for (const std::uint32_t vertex : triangles.data[i].vertex) {
      const double squared = squared_distance_in_double(positions[vertex], center);
      lower_to(&reach->farthest, ~double_bits(squared));
    }
  });
}

/// The arrays of one shape, and its pose.
template <class Device>
class ShapeThere {
 public:
  ShapeThere(Device& device, const RigShape& shape, const Mesh& mesh)
      : memory_(device.allocator()), joints_per_vertex_(shape.joints_per_vertex) {
    upload(device, View<const Vec3>(shape.positions), &positions_);
    upload(device, View<const Vec3>(shape.normals), &normals_);
    upload(device, View<const std::uint32_t>(shape.joints), &joints_);
    upload(device, View<const float>(shape.joint_weights), &joint_weights_);
    std::vector<Vec3> moves;
    for (const MorphTarget& target : shape.targets) {
      moves.insert(moves.end(), target.positions.begin(), target.positions.end());
      moves.insert(moves.end(), target.normals.begin(), target.normals.end());
    }
    upload(device, View<const Vec3>(moves), &moves_);
    std::vector<TargetView> targets;
    const Vec3* next = moves_.data();
    const auto take = [&next](const std::vector<Vec3>& field) {
      const Vec3* const first = next;
      next += field.size();
      return field.empty() ? nullptr : first;
    };
    for (const MorphTarget& target : shape.targets) {
      const Vec3* const of_positions = take(target.positions);
      targets.push_back({of_positions, take(target.normals)});
    }
    upload(device, View<const TargetView>(targets), &targets_);
    std::vector<StagedTriangle> flat;
    for (const std::uint32_t t : shape.flat_triangles) {
      const auto& [a, b, c] = mesh.triangles[t];
      flat.push_back({{a, b, c}});
    }
    upload(device, View<const StagedTriangle>(flat), &flat_triangles_);
    device.synchronize("copy: scene");
  }

  void take(Device& device, const MeshPose& pose, const VerticesThere& out,
            std::uint32_t* refused) {
    upload(device, View<const float>(pose.weights), &weights_);
    upload(device, View<const Affine>(pose.joints), &joint_maps_);
    deform_vertices_on(device,
                       {positions_.view_const(), normals_.view_const(), targets_.view_const(),
                        weights_.view_const(), joints_per_vertex_, joints_.view_const(),
                        joint_weights_.view_const(), joint_maps_.view_const()},
                       {out.positions, normals_.size() == 0 ? nullptr : out.normals}, refused);
    flatten_normals_on(device, flat_triangles_.view_const(), out, refused);
  }

 private:
  DeviceAllocator& memory_;
  std::uint32_t joints_per_vertex_;
  DeviceBuffer<Vec3> positions_{memory_}, normals_{memory_}, moves_{memory_};
  DeviceBuffer<TargetView> targets_{memory_};
  DeviceBuffer<std::uint32_t> joints_{memory_};
  DeviceBuffer<float> joint_weights_{memory_};
  DeviceBuffer<StagedTriangle> flat_triangles_{memory_};
  DeviceBuffer<float> weights_{memory_};  ///< of a pose
  DeviceBuffer<Affine> joint_maps_{memory_};
};

}  // namespace raysheaf
