// Whether rays and points enter instances where they stand (levels/levels.h), or instances are
// placed first, so that rays meet flat triangles.
//
// Both cost time once for each change of the scene, and time for each ray. Changes are known before
// the rays of later queries are, so this is a ski rental: an instance is entered until what rays
// have taken more since it last moved would have paid for placing what is entered; trees over
// meshes, which two levels need, are built when what placing has taken more would have paid for
// them. So the time is at most about twice that of the better choice.
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
  double ray_in_part = 100;    ///< the same where it enters only some instances, after the others
  double point = 400;          ///< the same of a point, and of what is inside
  std::uint64_t many_triangles = std::uint64_t{1} << 18;  ///< that do not fit the caches
  /// Fewer that are placed do not pay for a pass of their own: their instances are entered, too.
  std::uint64_t few_triangles = 64;
};

/// Those of a device, whose triangles the host places and sends: estimates.
inline constexpr LevelCosts kDeviceCosts{
    .moved_triangle = 8, .new_triangle = 10, .mesh_triangle = 4, .instance = 20, .ray = 1};

/// The work that the two ways would do for a query.
struct LevelWork {
  std::uint64_t moved_triangles = 0;    ///< of instances that wait to be placed
  std::uint64_t new_triangles = 0;      ///< of all that are placed then, if their tree is built
  std::uint64_t missing_triangles = 0;  ///< of meshes without a tree
  std::uint64_t instances = 0;          ///< to be settled for two levels
  std::uint64_t rays = 0;
  std::uint64_t points = 0;  ///< in place of rays
  bool in_part = false;      ///< rays meet placed triangles besides
  /// The triangles of all instances, and those of the meshes that they share.
  std::uint64_t placed_triangles = 0, mesh_triangles = 0;

  /// Whether placed triangles would not fit the caches, where those of meshes may.
  [[nodiscard]] bool has_many(const LevelCosts& costs = {}) const {
    return placed_triangles > costs.many_triangles && mesh_triangles <= placed_triangles / 4;
  }
};

class LevelPlan {
 public:
  /// Nanoseconds that were spent where instances were entered in place of being placed.
  [[nodiscard]] double spent_ns() const { return spent_ns_; }
  /// Instances have paid for being placed that have stood where they are since `spent_ns` was at
  /// most this, if the query enters them too.
  [[nodiscard]] double paid_since(const LevelWork& work, const LevelCosts& costs = {}) const {
    return spent_ns_ + enter_ns(work, costs) - place_ns(work, costs);
  }
  /// Whether the query's rays or points enter instances that have stood where they are since
  /// `spent_ns` was `since`.
  [[nodiscard]] bool enters(const LevelWork& work, double since, const LevelCosts& costs = {}) {
    const double meshes = costs.mesh_triangle * static_cast<double>(work.missing_triangles);
    const double saves = since - paid_since(work, costs);
    if (saves <= 0) return false;
    if (saved_ns_ + saves < meshes) {
      saved_ns_ += saves;
      return false;
    }
    if (work.missing_triangles != 0) saved_ns_ = 0;
    spent_ns_ += enter_ns(work, costs);
    return true;
  }

 private:
  [[nodiscard]] static double place_ns(const LevelWork& work, const LevelCosts& costs) {
    return costs.moved_triangle * static_cast<double>(work.moved_triangles) +
           costs.new_triangle * static_cast<double>(work.new_triangles);
  }
  [[nodiscard]] static double enter_ns(const LevelWork& work, const LevelCosts& costs) {
    const double ray = work.in_part ? costs.ray_in_part : costs.ray;
    const double items =
        ray * static_cast<double>(work.rays) + costs.point * static_cast<double>(work.points);
    return costs.instance * static_cast<double>(work.instances) +
           (work.has_many(costs) ? 0 : items);
  }

  double spent_ns_ = 0;
  double saved_ns_ = 0;  ///< that two levels would have saved, had there been trees of meshes
};

}  // namespace raysheaf
