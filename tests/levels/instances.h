// Instances under all kinds of transforms, and the scene that they make.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/mirrors_body.h"
#include "dual/dual_scenes.h"
#include "intersect/hit_filter.h"
#include "intersect/indexed_hit.h"
#include "levels/forest.h"
#include "levels/level_scene.h"
#include "scene/placed_runs.h"
#include "scene/placing.h"

namespace raysheaf::test {

enum class Kind {
  kIdentity,
  kMoved,
  kTurned,
  kQuarter,
  kSimilar,
  kScaled,
  kSheared,
  kMirrored,
  kSqueezed
};
inline constexpr Kind kKinds[] = {Kind::kIdentity, Kind::kMoved,    Kind::kTurned,
                                  Kind::kQuarter,  Kind::kSimilar,  Kind::kScaled,
                                  Kind::kSheared,  Kind::kMirrored, Kind::kSqueezed};

inline Affine random_map(Kind kind, float reach, Random& random) {
  const Affine turn = rotation(random.direction(), random.between(-3, 3));
  const auto factor = [&](float least, float most) {
    return std::exp(random.between(std::log(least), std::log(most)));
  };
  Affine map;
  switch (kind) {
    case Kind::kIdentity:
      return map;
    case Kind::kMoved:
      break;
    case Kind::kTurned:
      map = turn;
      break;
    case Kind::kQuarter:
      map.m = {{{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
      break;
    case Kind::kSimilar: {
      const float by = factor(1e-3f, 1e3f);
      map = compose(turn, scaling({by, by, by}));
      break;
    }
    case Kind::kScaled:
      map = compose(turn, scaling({1, 0.3f, 1.5f}));
      break;
    case Kind::kSheared:
      map.m[0][1] = 1.5f, map.m[2][0] = -0.7f;
      map = compose(turn, map);
      break;
    case Kind::kMirrored:
      map = compose(turn, scaling({-1, 1, 1}));
      break;
    case Kind::kSqueezed:
      map = compose(turn, scaling({1, 0.01f, 1}));
      break;
  }
  const Vec3 to = random.in_box(reach);
  map.m[0][3] = to.x, map.m[1][3] = to.y, map.m[2][3] = to.z;
  return map;
}

/// Instances of a few meshes, the scene that they make, and its two levels.
class Instances {
 public:
  void add_mesh(Soup soup) { meshes_.push_back(std::make_unique<Mesh>(std::move(soup))); }
  void place(std::size_t mesh, const Affine& map, WorldId own = kAllWorlds) {
    const Soup& soup = meshes_[mesh]->soup;
    LevelInstance instance;
    instance.tree = &meshes_[mesh]->tree;
    instance.geom_id = static_cast<std::uint32_t>(mesh);
    instance.inst_id = static_cast<std::uint32_t>(instances_.size());
    instance.mask = 1u << instance.inst_id % 3;
    instance.mirrored = mirrors(map);
    instance.placing = make_placing(map, instance.tree->bounds);
    if (!instance.placing.may_enter && !for_points) return;
    instances_.push_back(instance);
    worlds_.push_back(own);
    firsts_.push_back(world.count());
    for (const Vec3 p : soup.positions)
      world.positions.push_back(instance.placing.is_identity ? p : transform_point(map, p));
  }
  [[nodiscard]] LevelScene scene(bool refit = false) {
    std::vector<Box> boxes;
    for (const LevelInstance& instance : instances_)
      boxes.push_back(world_box(instance, fit_for(instances_.size())));
    if (refit)
      refit_top_tree(executor_, View<const Box>(boxes), &top_);
    else
      build_top_tree(executor_, View<const Box>(boxes), &top_);
    forest_.update(executor_, View<const Box>(boxes), View<const WorldId>(worlds_));
    return {View<const LevelInstance>(instances_), &top_, &forest_};
  }
  /// To where `map()` says; all are instances of the first mesh.
  template <class Map>
  void move_all(const Map& map) {
    const std::vector<LevelInstance> former = std::exchange(instances_, {});
    const std::vector<WorldId> worlds = std::exchange(worlds_, {});
    firsts_.clear();
    world = {};
    for (std::size_t i = 0; i < former.size(); ++i)
      while (instances_.size() == i) place(0, map(), worlds[i]);
  }
  /// Every hit that counts, by every triangle where it is placed.
  [[nodiscard]] std::vector<Hit> hits_of(const Ray& ray, std::uint32_t number,
                                         const HitChoice& choice) const {
    std::vector<Hit> hits;
    const RaySetup setup = make_ray_setup(ray);
    const std::uint32_t mask =
        choice.mask & (choice.masks != nullptr ? choice.masks[number] : 0xffffffff);
    for (std::size_t i = 0; i < instances_.size(); ++i) {
      const LevelInstance& instance = instances_[i];
      if ((instance.mask & mask) == 0) continue;
      const std::uint32_t end = i + 1 < firsts_.size() ? firsts_[i + 1] : world.count();
      for (std::uint32_t prim = 0; prim < end - firsts_[i]; ++prim) {
        const auto [a, b, c] = world.corners(firsts_[i] + prim);
        TriangleHit hit;
        if (!intersect_triangle(setup, a, b, c, &hit)) continue;
        const Sides side = hit.front != instance.mirrored ? Sides::kFront : Sides::kBack;
        if (choice.sides != Sides::kBoth && choice.sides != side) continue;
        const Hit one{hit.t, hit.u, hit.v, prim, instance.geom_id, instance.inst_id};
        if (choice.skips == nullptr || choice.skips[number].inst_id != one.inst_id ||
            choice.skips[number].prim_id != prim)
          hits.push_back(one);
      }
    }
    std::sort(hits.begin(), hits.end(), is_before);
    return hits;
  }
  [[nodiscard]] const Executor& executor() const { return executor_; }

  /// The instances where each triangle of the world is from.
  [[nodiscard]] const std::vector<LevelInstance>& instances() const { return instances_; }
  [[nodiscard]] WorldId world_of(std::size_t instance) const { return worlds_[instance]; }
  [[nodiscard]] std::uint32_t first_of(std::size_t instance) const { return firsts_[instance]; }
  /// As `PlacedRuns` lists them, and their masks.
  [[nodiscard]] std::vector<PlacedInstance> placed() {
    std::vector<PlacedInstance> all;
    for (std::size_t i = 0; i < instances_.size(); ++i) {
      const Soup& soup = meshes_[instances_[i].geom_id]->soup;
      PlacedInstance one;
      one.positions = View<const Vec3>(soup.positions);
      one.triangle_count = soup.count();
      one.geom_id = instances_[i].geom_id;
      one.inst_id = instances_[i].inst_id;
      one.to_world = instances_[i].placing.map;
      one.shape = 1 + one.geom_id;
      all.push_back(one);
    }
    std::stable_sort(all.begin(), all.end(), [](const PlacedInstance& a, const PlacedInstance& b) {
      return a.geom_id < b.geom_id;
    });
    return all;
  }
  [[nodiscard]] std::vector<LevelMark> marks() {
    std::vector<LevelMark> marks;
    for (const PlacedInstance& one : placed()) marks.push_back({1u << one.inst_id % 3});
    return marks;
  }
  [[nodiscard]] TriangleSource mesh_of(std::size_t instance) {
    return meshes_[instances_[instance].geom_id]->soup.source();
  }

  Soup world;
  bool for_points = false;  ///< instances count that rays cannot enter

 private:
  struct Mesh {
    explicit Mesh(Soup given) : soup(std::move(given)) {
      build_mesh_tree(Executor(1), soup.source(), &tree);
    }
    Soup soup;
    ObjectTree tree;
  };
  Executor executor_{2};
  std::vector<std::unique_ptr<Mesh>> meshes_;
  std::vector<LevelInstance> instances_;
  std::vector<WorldId> worlds_;        ///< of them
  std::vector<std::uint32_t> firsts_;  ///< triangles in `world`
  ObjectTree top_;
  Forest forest_;
};

/// Instances of two meshes, under transforms of every kind.
inline void fill_any(Instances* instances, Shape shape, float reach, Random& random) {
  instances->add_mesh(make_soup(shape, 60, random));
  instances->add_mesh(make_soup(Shape::kClosed, 100, random, 1, random.in_box(reach)));
  for (int i = 0; i < 12; ++i)
    instances->place(random.below(2), random_map(kKinds[random.below(9)], reach, random));
}

/// Instances of a scale, of a mesh that lies `offset` from the origin of its space.
inline void fill_scaled(Instances* instances, float scale, float offset, Random& random) {
  instances->add_mesh(make_soup(Shape::kSmall, 100, random, 1, {offset, offset, -offset}));
  for (int i = 0; i < 8; ++i) {
    const Affine map = random_map(Kind::kTurned, 10 * scale, random);
    instances->place(0, compose(map, scaling({scale, scale, scale})));
  }
}

/// The same rays with directions so many times as long. In the space of a mesh, a direction may
/// have a length that binary32 has no number for.
inline std::vector<Ray> lengthened(std::vector<Ray> rays, float times) {
  for (Ray& ray : rays) {
    ray.direction = ray.direction * times;
    ray.t_min /= times, ray.t_max /= times;
  }
  return rays;
}

}  // namespace raysheaf::test
