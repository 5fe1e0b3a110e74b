// Whether rays and points enter instances where they stand (levels/levels.h), or instances are
// placed first, so that rays meet flat triangles.
//
// Both cost time once for each change of the scene, and time for each ray. Changes are known before
// the rays of later queries are, so this is a ski rental: two levels are used until what their rays
// have taken more since the last change would have paid for placing; trees over meshes, which two
// levels need, are built when what placing has taken more would have paid for them. So the time is
// at most about twice that of the better choice.
//
// Where instances share meshes, and the placed triangles would not fit the caches, they take far
// more memory than the meshes, and rays gain little: rays never pay for placing them.
#pragma once

#include <cstdint>

namespace raysheaf {

/// Nanoseconds of one core, or of a device. Only their proportions matter.
struct LevelCosts {
  double moved_triangle = 25;  ///< placing its corners, and refitting the tree over it
  double new_triangle = 45;    ///< placing its corners, and building the tree
  double mesh_triangle = 50;   ///< building the tree of its mesh
  double instance = 250;       ///< its inverse, its box, and its part of the tree over instances
  double ray = 250;            ///< what a ray takes more in two levels than through flat triangles
  double point = 400;          ///< the same of a point, and of what is inside
  std::uint64_t many_triangles = std::uint64_t{1} << 18;  ///< that do not fit the caches
};

/// Those of a device, whose triangles the host places and sends: estimates.
inline constexpr LevelCosts kDeviceCosts{
    .moved_triangle = 8, .new_triangle = 10, .mesh_triangle = 4, .instance = 20, .ray = 1};

/// The work that the two ways would do for a query.
struct LevelWork {
  std::uint64_t moved_triangles = 0;    ///< of instances that wait to be placed
  std::uint64_t new_triangles = 0;      ///< of the whole scene, if its tree has to be built
  std::uint64_t missing_triangles = 0;  ///< of meshes without a tree
  std::uint64_t instances = 0;          ///< to be settled for two levels
  std::uint64_t rays = 0;
  std::uint64_t points = 0;  ///< in place of rays
  /// The triangles of all instances, and those of the meshes that they share.
  std::uint64_t placed_triangles = 0, mesh_triangles = 0;

  /// Whether placed triangles would not fit the caches, where those of meshes may.
  [[nodiscard]] bool has_many(const LevelCosts& costs = {}) const {
    return placed_triangles > costs.many_triangles && mesh_triangles <= placed_triangles / 4;
  }
};

class LevelPlan {
 public:
  /// Whether the query's rays enter instances. `is_new`: the scene has changed since the last
  /// query.
  [[nodiscard]] bool enters(const LevelWork& work, bool is_new, const LevelCosts& costs = {}) {
    if (is_new) spent_ns_ = 0;
    const double place = costs.moved_triangle * static_cast<double>(work.moved_triangles) +
                         costs.new_triangle * static_cast<double>(work.new_triangles);
    const double meshes = costs.mesh_triangle * static_cast<double>(work.missing_triangles);
    const double enter =
        costs.instance * static_cast<double>(work.instances) +
        (work.has_many(costs) ? 0
                              : costs.ray * static_cast<double>(work.rays) +
                                    costs.point * static_cast<double>(work.points));
    const double saves = place - enter - spent_ns_;
    if (saves <= 0) return false;
    if (saved_ns_ + saves < meshes) {
      saved_ns_ += saves;
      return false;
    }
    if (work.missing_triangles != 0) saved_ns_ = 0;
    spent_ns_ += enter;
    return true;
  }

 private:
  double spent_ns_ = 0;  ///< on two levels since the scene changed
  double saved_ns_ = 0;  ///< that two levels would have saved, had there been trees of meshes
};

}  // namespace raysheaf
