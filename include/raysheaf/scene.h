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
// A mesh is placed in the world by its instances, each with a transform and a mask. Changes show
// once `commit` was called. Nothing is built there: the query that follows builds what it needs.
//
// Threads: any number of them may query one committed scene at the same time. Whatever changes it
// needs it alone: a change during a query, or during another change, is refused with an `Error`
// (kWrongState) in the thread that asks for it, and nothing happens. A call that throws leaves the
// scene as it was.
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

/// Names a mesh: `Hit::geom_id`. The first is 0, each later one is larger by one; none is ever used
/// again, so that a hit never names a mesh which it has not met.
using MeshId = std::uint32_t;
/// Names an instance: `Hit::inst_id`. Counted over all meshes of a scene, as `MeshId` is.
using InstanceId = std::uint32_t;

using Triangle = std::array<std::uint32_t, 3>;  ///< a triangle's corners: indices into positions

enum class Storage : std::uint8_t {
  kCopy,  ///< the scene keeps arrays of its own
  /// The scene reads the caller's arrays where they lie: they must stay, and stay as they are,
  /// until `update` or `replace` gives others, or the mesh is removed. `update` may name the same
  /// array, whose content has changed since.
  kShare,
};

struct MeshOptions {
  Storage storage = Storage::kCopy;
  bool place = true;                ///< make a first instance, from the two fields below
  Affine transform = {};            ///< from the mesh's space to the world
  std::uint32_t mask = 0xffffffff;  ///< a query sees it where (mask & QueryOptions::mask) != 0
};

/// Movable, not copyable; one that was moved from may only be destroyed or assigned to.
class Scene {
 public:
  explicit Scene(const Context& context = Context());
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// A mesh, and its first instance where `options.place` says so. `Hit::prim_id` counts its
  /// `triangles`. Meshes without triangles are legal, triangles without area too: nothing hits
  /// them. Vertices that no triangle uses may be anything, NaN too. Throws `Error`: kInvalidData
  /// that names the first other vertex which is not finite or farther out than 1e18, or the first
  /// index out of range; kUnsupported above 2^31 - 1 vertices or triangles. O(vertices +
  /// triangles), at the speed of memory.
  MeshId add(std::span<const Vec3> positions, std::span<const Triangle> triangles,
             const MeshOptions& options = {});
  /// The same without indices: each three positions in a row are a triangle. Throws also where
  /// their number is no multiple of three (kInvalidArgument).
  MeshId add_soup(std::span<const Vec3> positions, const MeshOptions& options = {});

  /// Other vertices and other triangles, of any number; ids, instances and storage stay. Throws as
  /// `add` does, and for a mesh that is not there (kNotFound).
  void replace(MeshId mesh, std::span<const Vec3> positions, std::span<const Triangle> triangles);
  void replace_soup(MeshId mesh, std::span<const Vec3> positions);

  /// The vertices move, the triangles stay: what hierarchies stand on the mesh may be refitted
  /// instead of rebuilt. Throws as `replace` does, and where the number of positions is another one
  /// (kInvalidArgument).
  void update(MeshId mesh, std::span<const Vec3> positions);

  /// The mesh and all its instances. Throws for one that is not there (kNotFound).
  void remove(MeshId mesh);

  /// One more of a mesh, elsewhere. A flat or mirroring transform is legal. Throws `Error`:
  /// kNotFound for the mesh, kInvalidArgument for a transform that is not finite.
  InstanceId instance(MeshId mesh, const Affine& transform, std::uint32_t mask = 0xffffffff);
  /// The mesh stays, even without any instance. Throws kNotFound, as all below do.
  void remove_instance(InstanceId instance);
  void set_transform(InstanceId instance, const Affine& transform);
  void set_mask(InstanceId instance, std::uint32_t mask);

  /// Makes the changes since the last commit visible to queries: O(what has changed), and next to
  /// nothing where nothing has. Vertices go to the world here, where their instance's transform is
  /// not the identity. Throws `Error`: kInvalidData where a transform puts a triangle's vertex
  /// farther out than 1e18, kUnsupported above 2^31 - 1 triangles in all instances; the changes
  /// then wait for a later commit.
  void commit();
  /// Whether there is nothing to commit. Queries are refused where there is.
  [[nodiscard]] bool is_committed() const;

  [[nodiscard]] const Context& context() const;
  [[nodiscard]] bool contains(MeshId mesh) const;
  [[nodiscard]] bool contains_instance(InstanceId instance) const;
  [[nodiscard]] std::vector<MeshId> meshes() const;                    ///< ascending
  [[nodiscard]] std::vector<InstanceId> instances(MeshId mesh) const;  ///< ascending
  [[nodiscard]] MeshId mesh_of(InstanceId instance) const;
  [[nodiscard]] Affine transform(InstanceId instance) const;
  [[nodiscard]] std::uint32_t mask(InstanceId instance) const;

  [[nodiscard]] std::size_t mesh_count() const;
  [[nodiscard]] std::size_t instance_count() const;
  [[nodiscard]] std::size_t vertex_count(MeshId mesh) const;
  [[nodiscard]] std::size_t triangle_count(MeshId mesh) const;
  [[nodiscard]] std::uint64_t triangle_count() const;  ///< counted once an instance
  /// The box of all instances' triangles in the world, empty where there are none; under any mask.
  /// Throws kWrongState where there is something to commit. O(triangles) once a commit.
  [[nodiscard]] Box bounds() const;
  /// Arrays, hierarchies and the room that queries keep for the next one. Not shared arrays.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  friend struct SceneAccess;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
