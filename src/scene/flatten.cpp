// From a scene description to flat arrays of world-space triangles.
#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <string>

#include "exec/executor.h"
#include "raysheaf/error.h"
#include "scene/flat_scene.h"
#include "scene/flatten_body.h"
#include "scene/material_of.h"
#include "scene/mirrors.h"
#include "scene/shown_name.h"

namespace raysheaf {
namespace {

constexpr std::size_t kGrain = 2048;

/// The instances that have triangles, by (geom_id, inst_id).
std::vector<std::uint32_t> ordered_instances(const SceneDescription& scene) {
  std::vector<std::uint32_t> order(scene.instances.size());
  std::iota(order.begin(), order.end(), 0u);
  std::erase_if(order, [&](std::uint32_t i) {
    return scene.meshes[scene.instances[i].mesh].triangles.empty();
  });
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return scene.instances[a].mesh < scene.instances[b].mesh;
  });
  return order;
}

FlatMesh flat_mesh(const SceneDescription& scene, std::uint32_t inst_id, const Sphere& object_bound,
                   std::uint32_t first_triangle) {
  const Instance& instance = scene.instances[inst_id];
  FlatMesh mesh;
  mesh.first_triangle = first_triangle;
  mesh.triangle_count = static_cast<std::uint32_t>(scene.meshes[instance.mesh].triangles.size());
  mesh.geom_id = instance.mesh;
  mesh.inst_id = inst_id;
  mesh.mirrored = mirrors(instance.to_world);
  mesh.bound = transformed(object_bound, instance.to_world);
  // Where a mesh is huge in a direction that its instance flattens, the stretch alone says too
  // much: no two points of the scene are farther apart than this.
  mesh.bound.radius = std::min(mesh.bound.radius, 4 * kLargestCoordinate);
  return mesh;
}

void allocate(FlatScene& flat, std::uint32_t count) {
  const std::size_t padded = std::size_t{div_ceil(count, kTriangleBlock)} * kTriangleBlock;
  flat.triangle_count = count;
  for (auto& corner : flat.vertex) {
    for (auto& axis : corner) axis.resize(padded);
  }
  for (auto& field : flat.sphere) field.resize(padded);
  flat.flags.resize(padded);
  flat.mesh_of_triangle.resize(padded);
}

void store(FlatScene& flat, std::size_t i, const Vec3 (&corners)[3], const Sphere& sphere) {
  for (int k = 0; k < 3; ++k) {
    flat.vertex[k][0][i] = corners[k].x;
    flat.vertex[k][1][i] = corners[k].y;
    flat.vertex[k][2][i] = corners[k].z;
  }
  flat.sphere[0][i] = sphere.center.x;
  flat.sphere[1][i] = sphere.center.y;
  flat.sphere[2][i] = sphere.center.z;
  flat.sphere[3][i] = sphere.radius;
}

/// Fills triangles of one mesh at a time; says which mesh cannot be placed, and where all others
/// lie.
class Filler {
 public:
  explicit Filler(FlatScene& flat) : flat_(flat) {}

  void fill(std::size_t begin, std::size_t end) {
    const auto after = std::upper_bound(
        flat_.meshes.begin(), flat_.meshes.end(), begin,
        [](std::size_t triangle, const FlatMesh& mesh) { return triangle < mesh.first_triangle; });
    for (auto index = static_cast<std::uint32_t>(after - flat_.meshes.begin() - 1); begin < end;
         ++index) {
      const FlatMesh& mesh = flat_.meshes[index];
      const std::size_t stop =
          std::min(end, std::size_t{mesh.first_triangle} + mesh.triangle_count);
      Box box;
      if (!fill_mesh(index, begin, stop, box)) refuse(index);
      begin = stop;
      const std::lock_guard lock(mutex_);
      grow(&flat_.meshes[index].box, box);
      grow(&flat_.bounds, box);
    }
  }

  /// The least index of a mesh that cannot be placed, or `kInvalidId`.
  [[nodiscard]] std::uint32_t refused() const { return refused_; }

 private:
  bool fill_mesh(std::uint32_t index, std::size_t begin, std::size_t end, Box& box) {
    const FlatMesh& placed = flat_.meshes[index];
    const Mesh& mesh = flat_.description->meshes[placed.geom_id];
    const Affine& to_world = flat_.description->instances[placed.inst_id].to_world;
    for (std::size_t i = begin; i < end; ++i) {
      const auto prim_id = static_cast<std::uint32_t>(i - placed.first_triangle);
      Vec3 corners[3];
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = transform_point(to_world, mesh.positions[mesh.triangles[prim_id][k]]);
        if (!(max_component(abs(corners[k])) <= kLargestCoordinate)) return false;
        box.min = min(box.min, corners[k]);
        box.max = max(box.max, corners[k]);
      }
      if (has_no_area(corners[0], corners[1], corners[2])) corners[1] = corners[2] = corners[0];
      store(flat_, i, corners, conservative_triangle_sphere(corners[0], corners[1], corners[2]));
      flat_.flags[i] = flags_of(mesh, prim_id, placed.mirrored);
      flat_.mesh_of_triangle[i] = index;
    }
    return true;
  }

  [[nodiscard]] std::uint8_t flags_of(const Mesh& mesh, std::uint32_t prim_id,
                                      bool mirrored) const {
    const Material& material = material_or_default(*flat_.description, material_of(mesh, prim_id));
    return static_cast<std::uint8_t>((material.double_sided ? 0 : kSingleSided) |
                                     (mirrored ? kMirrored : 0));
  }

  static void grow(Box* box, const Box& by) {
    box->min = min(box->min, by.min);
    box->max = max(box->max, by.max);
  }

  void refuse(std::uint32_t index) {
    std::uint32_t least = refused_;
    while (index < least && !refused_.compare_exchange_weak(least, index)) {
    }
  }

  FlatScene& flat_;
  std::mutex mutex_;
  std::atomic<std::uint32_t> refused_{kInvalidId};
};

void pad(FlatScene& flat) {
  for (std::size_t i = flat.triangle_count; i < flat.flags.size(); ++i) {
    const std::uint32_t last = flat.triangle_count - 1;
    const Vec3 point = flat.corner(last, 0);
    store(flat, i, {point, point, point}, {point, kPaddingRadius});
    flat.flags[i] = flat.flags[last];
    flat.mesh_of_triangle[i] = flat.mesh_of_triangle[last];
  }
}

[[noreturn]] void throw_refused(const SceneDescription& scene, std::uint32_t inst_id) {
  const Instance& instance = scene.instances[inst_id];
  throw Error(ErrorCode::kInvalidData,
              "the transform" + of_name(instance.name) + " puts a vertex of meshes[" +
                  std::to_string(instance.mesh) + "] farther out than 1e18",
              "instances[" + std::to_string(inst_id) + "].to_world");
}

}  // namespace

TriangleView FlatScene::triangles() const {
  TriangleView view;
  view.count = triangle_count;
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) view.vertex[k][axis] = vertex[k][axis].data();
  }
  for (int field = 0; field < 4; ++field) view.sphere[field] = sphere[field].data();
  view.flags = flags.data();
  return view;
}

FlatScene flatten(const Executor& executor, const SceneDescription& description,
                  const std::vector<Sphere>& object_bounds) {
  constexpr std::uint64_t kMostTriangles = (std::uint64_t{1} << 31) - 64;
  const std::uint64_t count = description.triangle_count();
  if (count > kMostTriangles) {
    throw Error(ErrorCode::kUnsupported,
                "the scene has " + std::to_string(count) + " triangles, more than 2^31 - 64");
  }
  FlatScene flat;
  flat.description = &description;
  allocate(flat, static_cast<std::uint32_t>(count));
  std::uint32_t first_triangle = 0;
  for (const std::uint32_t inst_id : ordered_instances(description)) {
    const Sphere& object_bound = object_bounds[description.instances[inst_id].mesh];
    flat.meshes.push_back(flat_mesh(description, inst_id, object_bound, first_triangle));
    first_triangle += flat.meshes.back().triangle_count;
  }
  Filler filler(flat);
  executor.for_each_block(count, kGrain,
                          [&](std::size_t begin, std::size_t end) { filler.fill(begin, end); });
  if (filler.refused() != kInvalidId)
    throw_refused(description, flat.meshes[filler.refused()].inst_id);
  // The sum makes -0 into +0, which tasks may otherwise deliver in any order.
  flat.bounds.min += {0, 0, 0};
  flat.bounds.max += {0, 0, 0};
  pad(flat);
  return flat;
}

}  // namespace raysheaf
