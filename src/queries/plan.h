// The cost model: what a query does, chosen from its rays and its scene, and why.
//
// Costs are nanoseconds of one core, measured on one machine (docs/performance.md); what counts is
// their proportions, which move little from machine to machine. Everything is decided from
// nothing but the query's arguments, the scene's history and its tree, so that the same calls make
// the same choices with any number of threads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "methods/dual/dual.h"
#include "queries/query_report.h"
#include "rays/ray_source.h"

namespace raysheaf {

/// How alike rays are that stand beside each other, from a sample.
struct Coherence {
  double origin = 0;     ///< median extent of sixteen rays' origins, as a part of the whole's
  double direction = 0;  ///< part of such sixteens that run towards one quarter, with slopes alike

  [[nodiscard]] bool origins_alike() const { return origin < 0.2; }
  [[nodiscard]] bool directions_alike() const { return direction > 0.7; }
};

/// `whole`: what they may start in; null: the batch's own extent. O(1): a sample. Rays that are
/// wrong do no harm.
[[nodiscard]] Coherence sample_coherence(const RaySource& rays, const Box* whole = nullptr);

/// A tree whose expected cost has grown by this much since it was built is not refitted again.
inline constexpr float kSpoilt = 1.5f;

/// Of tiles of a fan and triangles, a triangle, before any fan was used.
inline constexpr double kFanPairs = 0.25;

/// The fate of fans while triangles changed. A fan that is given up has cost its keys and its
/// sort, and the tree is built after all. Where that happens after one change and after the next,
/// twice as many changes pass before the next attempt.
struct FanHistory {
  /// Then one set in sixty-four pays for a fan that is given up.
  static constexpr std::uint32_t kMostPatience = 63;

  bool done = false, given_up = false;  ///< any fan, since the triangles last changed
  bool waits = false;                   ///< no fan is tried until they change again
  std::uint32_t patience = 0;           ///< changes that pass after the next fan that is given up
  std::uint32_t pause = 0;              ///< changes that have yet to pass

  void change_triangles();
};

/// What the scene has been through.
struct SceneHistory {
  std::uint32_t triangles = 0;
  bool built = false;     ///< there is a tree of these triangles, at these places or at former ones
  bool moved = false;     ///< at former ones
  bool fine = false;      ///< it was built by surface area
  bool degraded = false;  ///< refits have made it much worse than it was built
  std::uint32_t moves = 0;     ///< since the triangles were last replaced
  std::uint32_t patience = 2;  ///< moves before a fine tree is tried
  std::uint32_t queries_since_change = 0;
  std::uint64_t rays_since_change = 0;  ///< that went through the tree
  /// Pairs of fan tiles and triangles, a triangle, in these triangles' last fan; for `kFanRays`.
  double fan_pairs = kFanPairs;
  /// The same when one of any triangles was last used to its end: others are expected to be alike.
  double usual_fan_pairs = kFanPairs;
  FanHistory fans;

  /// Other triangles.
  [[nodiscard]] SceneHistory replaced(std::uint32_t new_triangles) const;
  /// The same triangles in other places.
  void move();
  /// A fine tree was spoilt: it is tried again, but not so soon.
  void wait_longer();
};

struct Plan {
  bool fan = false;  ///< triangles stream against cells over the rays; there is no object tree
  std::uint64_t most_fan_pairs = 0;  ///< of tiles and triangles; with more the tree is quicker
  TreeWork tree = TreeWork::kKeep;
  bool alike = false;  ///< neighbouring rays start close together and are coherent
  Bundle bundle = Bundle::kSixteen;
  std::size_t row = 0;               ///< rays of a row, of a picture (queries/picture_rows.h); or 0
  std::vector<std::string> reasons;  ///< a sentence a choice
};

/// `any`: an any-hit query. `explain`: write the reasons. A plan for a fan is made from a sample of
/// the rays, and from what an earlier fan has met: where others start elsewhere, and where there is
/// far more to meet, `plan_without_fan` is what remains.
[[nodiscard]] Plan make_plan(const SceneHistory& scene, const RaySource& rays, bool any,
                             bool explain);
[[nodiscard]] Plan plan_without_fan(const SceneHistory& scene, const RaySource& rays, bool explain);

/// The halves of `plan_without_fan`: what becomes of the tree, and how a few rays of many go
/// through one, of triangles that lie in `whole`.
[[nodiscard]] Plan plan_tree(const SceneHistory& scene, bool explain);
[[nodiscard]] Plan plan_rays(const SceneHistory& scene, const RaySource& rays, const Box& whole,
                             bool explain);

}  // namespace raysheaf
