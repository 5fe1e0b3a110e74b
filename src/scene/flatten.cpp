// Converts a scene description to flat arrays of world-space triangles.
#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <string>

#include "exec/executor.h"
#include "raysheaf/error.h"
#include "scene/flat_update.h"
#include "scene/flatten_body.h"
#include "scene/material_of.h"
#include "scene/mirrors.h"
#include "scene/shown_name.h"

namespace raysheaf {
namespace {

/// The instances that have triangles, sorted by (geom_id, inst_id).
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
  // If a mesh is huge in a direction that its instance flattens, the largest stretch overestimates
  // the radius. No two points of the scene are farther apart than this.
  mesh.bound.radius = std::min(mesh.bound.radius, 4 * kLargestCoordinate);
  return mesh;
}

void grow(Box* box, const Box& by) {
  box->min = min(box->min, by.min);
  box->max = max(box->max, by.max);
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

/// Fills the triangles of some meshes, and computes the meshes' boxes. Records a mesh that cannot
/// be placed.
class Filler {
 public:
  /// `places`: indices in `flat.meshes`, ascending. Their boxes start empty.
  Filler(FlatScene& flat, const std::vector<std::uint32_t>& places) : flat_(flat), places_(places) {
    starts_.reserve(places.size() + 1);
    starts_.push_back(0);
    for (const std::uint32_t place : places) {
      flat.meshes[place].box = {};
      starts_.push_back(starts_.back() + flat.meshes[place].triangle_count);
    }
  }

  [[nodiscard]] std::size_t triangle_count() const { return starts_.back(); }

  /// Fills triangles [begin, end), counted over these meshes.
  void fill(std::size_t begin, std::size_t end) {
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), begin);
    for (auto i = static_cast<std::size_t>(after - starts_.begin() - 1); begin < end; ++i) {
      const std::uint32_t index = places_[i];
      const std::size_t first = flat_.meshes[index].first_triangle;
      const std::size_t stop = std::min(end, starts_[i + 1]);
      Box box;
      if (!fill_mesh(index, first + begin - starts_[i], first + stop - starts_[i], box))
        refuse(index);
      begin = stop;
      const std::lock_guard lock(mutex_);
      grow(&flat_.meshes[index].box, box);
    }
  }

  /// The smallest index of a mesh that cannot be placed, or `kInvalidId`.
  [[nodiscard]] std::uint32_t refused() const { return refused_; }

 private:
  bool fill_mesh(std::uint32_t index, std::size_t begin, std::size_t end, Box& box) {
    const FlatMesh& placed = flat_.meshes[index];
    const Mesh& mesh = flat_.description->meshes[placed.geom_id];
    const Affine& to_world = flat_.description->instances[placed.inst_id].to_world;
    for (std::size_t i = begin; i < end; ++i) {
      const auto prim_id = static_cast<std::uint32_t>(i - placed.first_triangle);
      Vec3 corners[3];
      for (std::size_t k = 0; k < 3; ++k) corners[k] = mesh.positions[mesh.triangles[prim_id][k]];
      if (!place_corners(to_world, corners)) return false;
      for (const Vec3& corner : corners) {
        box.min = min(box.min, corner);
        box.max = max(box.max, corner);
      }
      collapse_flat(corners);
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

  void refuse(std::uint32_t index) {
    std::uint32_t least = refused_;
    while (index < least && !refused_.compare_exchange_weak(least, index)) {
    }
  }

  FlatScene& flat_;
  const std::vector<std::uint32_t>& places_;
  std::vector<std::size_t> starts_;  ///< the first triangle of each mesh, and the end, counted over
                                     ///< these meshes
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

/// The number of triangles of all instances; throws if it is too large.
std::uint32_t checked_count(const SceneDescription& description) {
  constexpr std::uint64_t kMostTriangles = (std::uint64_t{1} << 31) - 64;
  const std::uint64_t count = description.triangle_count();
  if (count > kMostTriangles) {
    throw Error(ErrorCode::kUnsupported,
                "the scene has " + std::to_string(count) + " triangles, more than 2^31 - 64");
  }
  return static_cast<std::uint32_t>(count);
}

/// The range of triangles of each instance, with its ids; everything else is filled later.
std::vector<FlatMesh> layout(const SceneDescription& description) {
  std::vector<FlatMesh> meshes;
  std::uint32_t first_triangle = 0;
  for (const std::uint32_t inst_id : ordered_instances(description)) {
    FlatMesh mesh;
    mesh.geom_id = description.instances[inst_id].mesh;
    mesh.inst_id = inst_id;
    mesh.first_triangle = first_triangle;
    mesh.triangle_count =
        static_cast<std::uint32_t>(description.meshes[mesh.geom_id].triangles.size());
    first_triangle += mesh.triangle_count;
    meshes.push_back(mesh);
  }
  return meshes;
}

/// Fills the meshes at the indices `places` in `flat->meshes`, and the box of the scene.
void place(const Executor& executor, const std::vector<Sphere>& object_bounds,
           const std::vector<std::uint32_t>& places, FlatScene* flat) {
  const SceneDescription& description = *flat->description;
  const std::uint32_t count = checked_count(description);
  if (count != flat->triangle_count || flat->flags.empty()) allocate(*flat, count);
  for (const std::uint32_t i : places) {
    FlatMesh& mesh = flat->meshes[i];
    mesh = flat_mesh(description, mesh.inst_id, object_bounds[mesh.geom_id], mesh.first_triangle);
  }
  Filler filler(*flat, places);
  executor.for_each_block(filler.triangle_count(), kWorkGrain,
                          [&](std::size_t begin, std::size_t end) { filler.fill(begin, end); });
  if (filler.refused() != kInvalidId)
    throw_refused(description, flat->meshes[filler.refused()].inst_id);
  flat->bounds = {};
  for (FlatMesh& mesh : flat->meshes) {
    // Adding 0 turns -0 into +0. Which of the two a box gets would depend on the order of the
    // tasks.
    mesh.box.min += {0, 0, 0};
    mesh.box.max += {0, 0, 0};
    grow(&flat->bounds, mesh.box);
  }
  pad(*flat);
}

/// Flags for the indices [from, count) and the listed ones.
std::vector<char> marked(const std::vector<std::uint32_t>& listed, std::uint32_t from,
                         std::size_t count) {
  std::vector<char> marks(count, 0);
  if (from < count) std::fill(marks.begin() + from, marks.end(), char{1});
  for (const std::uint32_t i : listed) marks[i] = 1;
  return marks;
}

bool stands(const FlatMesh& a, const FlatMesh& b) {
  return a.first_triangle == b.first_triangle && a.triangle_count == b.triangle_count &&
         a.geom_id == b.geom_id && a.inst_id == b.inst_id;
}

/// Lays out the meshes after the changes; returns the indices of those that must be filled.
std::vector<std::uint32_t> lay_out_again(const SceneDescription& description,
                                         const SceneChanges& changes, FlatScene* flat) {
  const std::uint32_t mesh_from = changes.everything ? 0 : changes.other_meshes_from;
  const std::uint32_t instance_from = changes.everything ? 0 : changes.other_instances_from;
  const bool same = mesh_from == kInvalidId && instance_from == kInvalidId;
  std::vector<FlatMesh> meshes = same ? flat->meshes : layout(description);
  const std::vector<char> mesh_marks =
      marked(changes.deformed, mesh_from, description.meshes.size());
  const std::vector<char> instance_marks =
      marked(changes.moved, instance_from, description.instances.size());
  std::vector<std::uint32_t> places;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const bool stays = i < flat->meshes.size() && stands(meshes[i], flat->meshes[i]) &&
                       mesh_marks[meshes[i].geom_id] == 0 && instance_marks[meshes[i].inst_id] == 0;
    if (stays) {
      meshes[i] = flat->meshes[i];
    } else {
      places.push_back(static_cast<std::uint32_t>(i));
    }
  }
  flat->meshes = std::move(meshes);
  return places;
}

void count_placed(const FlatScene& flat, FlatUpdate* update) {
  for (const std::uint32_t i : update->placed_meshes)
    update->placed_triangles += flat.meshes[i].triangle_count;
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
  FlatScene flat;
  flat.description = &description;
  flat.meshes = layout(description);
  std::vector<std::uint32_t> places(flat.meshes.size());
  std::iota(places.begin(), places.end(), 0u);
  place(executor, object_bounds, places, &flat);
  return flat;
}

FlatUpdate update_flat(const Executor& executor, const SceneDescription& description,
                       const SceneChanges& changes, const std::vector<Sphere>& object_bounds,
                       FlatScene* flat) {
  FlatUpdate update;
  flat->description = &description;
  update.placed_meshes = lay_out_again(description, changes, flat);
  const bool other = changes.everything || changes.other_meshes_from != kInvalidId ||
                     changes.other_instances_from != kInvalidId;
  update.same_triangles = !other;
  update.everything = changes.everything;
  place(executor, object_bounds, update.placed_meshes, flat);
  count_placed(*flat, &update);
  return update;
}

FlatUpdate move_flat_meshes(const SceneDescription& description, const SceneChanges& changes,
                            const std::vector<Sphere>& object_bounds, FlatScene* flat) {
  FlatUpdate update;
  flat->description = &description;
  update.placed_meshes = lay_out_again(description, changes, flat);
  update.same_triangles = true;
  for (const std::uint32_t i : update.placed_meshes) {
    FlatMesh& mesh = flat->meshes[i];
    mesh = flat_mesh(description, mesh.inst_id, object_bounds[mesh.geom_id], mesh.first_triangle);
  }
  count_placed(*flat, &update);
  return update;
}

}  // namespace raysheaf
