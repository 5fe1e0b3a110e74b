// A scene with a history, and a model of it: lists of triangles that know nothing of hierarchies.
// In half of them instances are in worlds, and in half of them they may move with time.
//
// Its meshes are of very different sizes: soups and closed meshes, tiny or large copies of them,
// and often a ground plane or a sky box of 10^3 to 10^9 times their size.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lab/verify/soup.h"
#include "raysheaf/scene.h"

namespace raysheaf::checks {

/// An instance with triangles.
struct Placed {
  InstanceId instance = 0;
  MeshId mesh = 0;
  std::uint32_t mask = 0;
  WorldId world = kAllWorlds;
  bool mirrored = false;  ///< at the time, exactly
};

/// The triangles of a world as they were last committed, at a time.
struct WorldView {
  /// One mesh for each of `placed`, in world space. `scale` and `offset` are those of the world,
  /// so that rays for soups suit it.
  Soup soup;
  std::vector<Placed> placed;  ///< ascending by (mesh, instance)
  bool is_whole = false;       ///< most coordinates are whole numbers, in scales
};

/// One of a few worlds, or all.
[[nodiscard]] WorldId some_world(Random* random);

class World {
 public:
  World(const Context& context, std::uint64_t seed);
  // A scene may share the arrays of its world.
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Some random changes and a commit. Returns a sentence if the scene accepted a change that it
  /// must refuse or conversely, otherwise nothing.
  [[nodiscard]] std::string change();

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] bool moves() const { return moves_; }
  /// The instances are the same at all times.
  [[nodiscard]] WorldView view(float time = 0) const;
  /// The changes before the last commit: "add, update, copy".
  [[nodiscard]] const std::string& last_changes() const { return changes_; }

 private:
  struct Part {
    std::string kind;
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    bool is_soup = true;
  };
  struct WorldMesh {
    Part part;
    std::vector<Vec3> home;  ///< the positions as they were added
  };
  struct Instance {
    MeshId mesh = 0;
    std::vector<Affine> transforms;  ///< one, or several in time
    std::uint32_t mask = 0;
    WorldId world = kAllWorlds;
  };

  [[nodiscard]] Part some_part();
  [[nodiscard]] Part ground();
  [[nodiscard]] Part sky();
  [[nodiscard]] Part closed();
  [[nodiscard]] Part soup();
  [[nodiscard]] Affine some_transform();
  [[nodiscard]] std::vector<Affine> some_transforms(std::size_t count);
  [[nodiscard]] Affine next_to(const Affine& transform);
  [[nodiscard]] std::size_t some_times();
  [[nodiscard]] WorldId world_of_new();
  [[nodiscard]] MeshId some_mesh();
  [[nodiscard]] InstanceId some_instance();
  [[nodiscard]] std::size_t triangle_count() const;
  [[nodiscard]] std::vector<Vec3> corners(const Instance& instance, const Affine& transform) const;
  enum class Fit { kSure, kUnsure, kNone };
  [[nodiscard]] Fit fit_of(const Instance& instance) const;

  void add(Part part);
  void replace();
  void update();
  void move(std::vector<Vec3>* positions, const std::vector<Vec3>& home);
  void remove();
  void place();
  void place_many();
  void remove_instance();
  void set_transform();
  void set_transforms();
  void set_mask();
  void set_world();
  void copy();
  void refuse();
  void commit();

  Random random_;
  float size_;
  Vec3 offset_;
  bool is_whole_;  ///< its soups have whole numbers as coordinates, in sizes
  bool has_worlds_, moves_;
  Scene scene_;
  std::map<MeshId, WorldMesh> meshes_;
  std::map<InstanceId, Instance> instances_;
  std::string changes_, fault_;
};

}  // namespace raysheaf::checks
