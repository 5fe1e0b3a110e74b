// Triangles that may change completely between any two batches of rays (raysheaf/query.h).
//
//   raysheaf::Scene scene;
//   const raysheaf::MeshId cloth = scene.add(positions, triangles);
//   for (;;) {
//     scene.update(cloth, moved_positions);
//     scene.commit();
//     raysheaf::closest_hit(scene, rays, hits);
//   }
//
// Instances place a mesh in the world, each with a transform and a mask. Changes become visible
// with `commit`, which builds no hierarchy: the next query builds what it needs.
//
// Thousands of small scenes can be one: each instance is in one world, or in all of them, and each
// ray sees the instances of its own (`QueryOptions::ray_worlds`).
//
// Instances and the vertices of meshes may move while rays are cast, as during a sweep of a lidar:
// they have several transforms or positions, and each ray has a time (`QueryOptions::ray_times`).
// Everything else, rays without times, points, `bounds` and frames, meets the scene at time 0.
//
// Threads: any number of them may query one committed scene at the same time. A change needs
// exclusive access: during a query or another change it throws `Error` (kWrongState) in its own
// thread and has no effect. A call that throws leaves the scene unchanged.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "raysheaf/context.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Names a mesh: `Hit::geom_id`. The first is 0, each later one is larger by one; ids are never
/// reused, so that the ids of a hit stay unambiguous.
using MeshId = std::uint32_t;
/// Names an instance: `Hit::inst_id`. Counted over all meshes of a scene, as `MeshId` is.
using InstanceId = std::uint32_t;

using Triangle = std::array<std::uint32_t, 3>;  ///< a triangle's corners: indices into positions

enum class Storage : std::uint8_t {
  kCopy,  ///< the scene copies the arrays
  /// The scene reads the caller's arrays in place: they must exist and not change until `update`
  /// or `replace` names others, or the mesh is removed. `update` may name the same array with
  /// changed content.
  kShare,
};

struct MeshOptions {
  Storage storage = Storage::kCopy;
  bool place = true;      ///< add a first instance, with the next three fields
  Affine transform = {};  ///< from the mesh's space to the world
  /// A query sees the instance if (mask & QueryOptions::mask) != 0.
  std::uint32_t mask = 0xffffffff;
  WorldId world = kAllWorlds;  ///< that the instance is in
};

/// Where an instance with these transforms, one or more, is at a time from 0 to 1: under the first
/// at 0, the last at 1, and the others at equal distances between. With x = time * (size - 1),
/// j = floor(x) and f = x - j, an entry between a of transforms[j] and b of transforms[j + 1] is
/// (1 - f) * a + f * b, each operation rounded to binary64, and the sum then to binary32. Corners
/// move along straight lines from one transform to the next: an instance that turns needs one every
/// few degrees.
[[nodiscard]] Affine transform_at(std::span<const Affine> transforms, float time);

/// Movable, not copyable; a moved-from scene may only be destroyed or assigned to.
class Scene {
 public:
  explicit Scene(const Context& context = Context());
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// Adds a mesh, and with `options.place` its first instance. `Hit::prim_id` is an index into its
  /// `triangles`. Meshes without triangles and triangles without area are legal: no ray hits them.
  /// Vertices that no triangle uses may have any value, including NaN. Throws `Error`: kInvalidData
  /// naming the first other vertex that is not finite or farther out than 1e18, or the first index
  /// out of range; kUnsupported above 2^31 - 1 vertices or triangles. O(vertices + triangles), at
  /// the speed of memory.
  MeshId add(std::span<const Vec3> positions, std::span<const Triangle> triangles,
             const MeshOptions& options = {});
  /// The same without indices: each three consecutive positions are a triangle. Throws also if
  /// their number is not a multiple of three (kInvalidArgument).
  MeshId add_soup(std::span<const Vec3> positions, const MeshOptions& options = {});

  /// Gives the mesh other vertices and triangles, any number; it keeps its id, instances and
  /// storage. Throws as `add` does, and for a mesh that does not exist (kNotFound).
  void replace(MeshId mesh, std::span<const Vec3> positions, std::span<const Triangle> triangles);
  void replace_soup(MeshId mesh, std::span<const Vec3> positions);

  /// Moves the vertices; the triangles stay, so hierarchies may be refitted instead of rebuilt.
  /// Throws as `replace` does, and for a different number of positions (kInvalidArgument).
  void update(MeshId mesh, std::span<const Vec3> positions);
  /// Lets the vertices move from time 0 to time 1: a ray meets those of its time (`positions_at`).
  void update(MeshId mesh, std::span<const Vec3> begin, std::span<const Vec3> end);
  /// The same with as many positions of each vertex as there are `times`, one or more, at equal
  /// distances of time: those of all vertices at time 0, then those at the next. Throws also for no
  /// times (kInvalidArgument).
  void update(MeshId mesh, std::span<const Vec3> positions, std::size_t times);

  /// Removes the mesh and all its instances. Throws if it does not exist (kNotFound).
  void remove(MeshId mesh);

  /// Places the mesh once more. The transform may be singular or mirror the mesh. Throws `Error`:
  /// kNotFound for the mesh, kInvalidArgument for a transform that is not finite.
  InstanceId instance(MeshId mesh, const Affine& transform, std::uint32_t mask = 0xffffffff,
                      WorldId world = kAllWorlds);
  /// `instance` once for each transform, all or none; worlds[i] is that of transforms[i], and
  /// without worlds all are in `kAllWorlds`. Returns the first id; the others follow it. Throws
  /// also for spans of unequal length (kInvalidArgument).
  InstanceId instances(MeshId mesh, std::span<const Affine> transforms,
                       std::span<const WorldId> worlds = {}, std::uint32_t mask = 0xffffffff);
  /// Removes the instance; the mesh stays, even without instances. Throws kNotFound, as do all
  /// functions below that take an id.
  void remove_instance(InstanceId instance);
  void set_transform(InstanceId instance, const Affine& transform);
  /// Lets the instance move from time 0 to time 1: a ray meets it under `transform_at` of its time.
  void set_transform(InstanceId instance, const Affine& begin, const Affine& end);
  /// `set_transform` of all of them or none. Each has `each` transforms, one or more, so that those
  /// of instances[i] are transforms[i * each] up to, excluding, transforms[(i + 1) * each], for
  /// `transform_at`. Throws also for spans of other lengths (kInvalidArgument).
  void set_transforms(std::span<const InstanceId> instances, std::span<const Affine> transforms,
                      std::size_t each = 1);
  void set_mask(InstanceId instance, std::uint32_t mask);
  void set_world(InstanceId instance, WorldId world);

  /// Makes the changes since the last commit visible to queries, in time proportional to what has
  /// changed. Touches no vertex: instances are placed in the world by the first query that needs
  /// it, unless a transform may move a vertex farther out than 1e18. Throws `Error`: kInvalidData
  /// if a transform moves a triangle's vertex farther out than 1e18, or may while one of the two
  /// has several times;
  /// the changes then wait for a later commit. All instances may have any number of triangles;
  /// above 2^31 - 1 together, points on devices are refused (docs/limits.md).
  void commit();
  /// Whether no changes wait for `commit`. Queries are refused while changes wait.
  [[nodiscard]] bool is_committed() const;

  /// A scene with the same meshes, instances, ids and context, whose arrays are copies of its own,
  /// even of shared ones. Changes that wait here wait there. Its hierarchies are built again.
  [[nodiscard]] Scene copy() const;

  [[nodiscard]] const Context& context() const;
  [[nodiscard]] bool has_mesh(MeshId mesh) const;
  [[nodiscard]] bool has_instance(InstanceId instance) const;
  [[nodiscard]] std::vector<MeshId> meshes() const;                    ///< ascending
  [[nodiscard]] std::vector<InstanceId> instances(MeshId mesh) const;  ///< ascending
  [[nodiscard]] MeshId mesh_of(InstanceId instance) const;
  [[nodiscard]] Affine transform(InstanceId instance) const;                ///< at time 0
  [[nodiscard]] std::vector<Affine> transforms(InstanceId instance) const;  ///< one unless it moves
  [[nodiscard]] std::uint32_t mask(InstanceId instance) const;
  [[nodiscard]] WorldId world(InstanceId instance) const;

  [[nodiscard]] std::size_t mesh_count() const;
  [[nodiscard]] std::size_t instance_count() const;
  /// The number of times at which its positions are given: one unless its vertices move.
  [[nodiscard]] std::size_t time_count(MeshId mesh) const;
  /// As they were last given, whether committed or not; -0 has become 0 in copies. Valid until the
  /// mesh changes or is removed. A soup has no array of triangles. Throws `Error`
  /// (kInvalidArgument) for a time that is not below `time_count`.
  [[nodiscard]] std::span<const Vec3> positions(MeshId mesh, std::size_t time = 0) const;
  /// The vertices at a time from 0 to 1, mixed from positions as `transform_at` mixes entries.
  /// Throws `Error` (kInvalidArgument) for another time.
  [[nodiscard]] std::vector<Vec3> positions_at(MeshId mesh, float time) const;
  [[nodiscard]] std::span<const Triangle> triangles(MeshId mesh) const;
  [[nodiscard]] bool is_soup(MeshId mesh) const;
  /// The ids of the next mesh and of the next instance.
  [[nodiscard]] MeshId next_mesh() const;
  [[nodiscard]] InstanceId next_instance() const;
  /// Gives up the ids below these, so that a scene can be made again with the ids that it had.
  /// Throws `Error` (kInvalidArgument) for ids that are below the next ones.
  void continue_ids(MeshId next_mesh, InstanceId next_instance);

  [[nodiscard]] std::size_t vertex_count(MeshId mesh) const;
  [[nodiscard]] std::size_t triangle_count(MeshId mesh) const;
  [[nodiscard]] std::uint64_t triangle_count() const;  ///< counted for each instance
  /// The box of all instances' triangles in world space, whatever their masks; empty without
  /// triangles. Throws kWrongState while changes wait for `commit`. O(instances), the
  /// triangles of meshes, and those of instances at the border, once for each commit.
  [[nodiscard]] Box bounds() const;
  /// Arrays, hierarchies and memory that is kept for the next query, without shared arrays.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  friend struct SceneAccess;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
