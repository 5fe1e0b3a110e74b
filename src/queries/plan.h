// The cost model: chooses how a query is answered from its rays and its scene.
//
//   SceneHistory ─► TreePlan ┐
//                            ├─► Plan ─► explain: a sentence for each choice
//   rays ──────────► RayPlan ┘
//
// All decisions depend only on the query's arguments, the scene's history and its tree, so that the
// same calls make the same choices with any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "methods/dual/dual.h"
#include "object_tree/object_tree.h"
#include "queries/query_report.h"
#include "queries/ray_samples.h"
#include "rays/ray_source.h"

namespace raysheaf {

/// Nanoseconds of one core. Only proportions matter, which differ little between machines. Trees
/// were measured by their builds and refits, rays by tracing the same ones through the trees that
/// are compared, in the scenes of `raysheaf bench plan` on one machine (docs/performance.md).
/// docs/decisions/0019-costs-that-matter.md says how much depends on each.
struct Costs {
  using ByJoining = std::array<double, 3>;  ///< indexed by `Joining`

  // For each triangle: a quick build, and by how much large leaves make it and its refits shorter.
  double build = 40;
  ByJoining coarse_build_saves = {20, 14, 14}, coarse_refit_saves = {8, 4, 2};
  // A build by surface area, and how much longer a refit of its tree takes than of a quick one: it
  // has fewer triangles per quad.
  double fine_build = 500, fine_refit_adds = 8;

  double ray_level = 7;  ///< a ray by itself, for each doubling of the triangles
  /// A part of this time, without unit. Joined leaves are of one size, as fine as they can be, and
  /// their quads are fuller.
  ByJoining fine_saves = {0.1, 0.1, 0};
  /// A ray's loss in large leaves, divided by the root of the number of triangles per ray: of a ray
  /// by itself, and of an any-hit ray in a stream, where rays together miss most of a large leaf.
  double coarse_ray = 30, coarse_ray_together = 9;
  /// Any-hit rays in a stream that take as long as one ray by itself; without unit.
  std::uint64_t together = 4;
};

/// A tree whose expected cost has grown by this factor since it was built is not refitted again.
inline constexpr float kSpoilt = 1.5f;

/// The rays for which a tree is prepared.
struct TreeRays {
  std::uint64_t count = 0;  ///< 0: unknown
  bool together = false;    ///< any-hit rays that traverse the tree in streams
};

enum class TreeReason : std::uint8_t {
  kNew,       ///< there is no tree of these triangles
  kDegraded,  ///< refits have made the tree much worse than when it was built
  kOutgrown,  ///< so many rays have met its large leaves
  kMoved,     ///< the same triangles have moved
  kUnmoved
};

/// How the tree is prepared.
struct TreePlan {
  TreeWork work = TreeWork::kKeep;
  TreeReason reason = TreeReason::kNew;
  /// A slice of a fine tree is built in addition, because the same triangles keep moving (kMoved)
  /// or so many rays have met unmoved ones, or their large leaves.
  bool finely = false;
  TreeRays rays;  ///< for which it is prepared
  /// Found on the way: triangles without area have gained an area, so that the work became a
  /// rebuild.
  bool gained_area = false;
};

/// A scene's triangles and the age of its tree, by what happened to them.
class SceneHistory {
 public:
  explicit SceneHistory(const Costs& costs = {}) : costs_(costs) {}

  /// The triangles are new.
  void replaced(std::uint32_t triangles, Joining joining = Joining::kNone);
  /// The same triangles have moved.
  void moved();
  /// From now on until `tree_was` there is no tree, even if memory runs out or the caller cancels.
  void tree_changes() { built_ = false; }
  /// The tree was prepared by this work; `cost` is its `surface_area_cost`.
  void tree_was(TreeWork work, float cost);
  /// A fine tree was begun in vain: the next attempt waits longer.
  void fine_tree_was_given_up();
  /// A rebuild joins the triangles, which may have moved, like this.
  void joined(Joining joining) { joining_ = joining; }
  /// These rays are traced through the tree.
  void traced(const TreeRays& rays);

  [[nodiscard]] TreePlan plan(const TreeRays& rays) const;
  /// The time that a fine tree may take from a query of these rays, in nanoseconds of one core, so
  /// that no query takes much longer than the others.
  [[nodiscard]] double slice(const TreeRays& rays) const;
  [[nodiscard]] Joining joining() const { return joining_; }
  [[nodiscard]] bool has_moved() const { return moves_ != 0; }  ///< since they were replaced

 private:
  [[nodiscard]] double of(const Costs::ByJoining& cost) const;
  [[nodiscard]] std::uint64_t alone(const TreeRays& rays) const;
  [[nodiscard]] double trace_time(std::uint64_t rays) const;
  [[nodiscard]] double fine_gain(std::uint64_t rays) const;
  [[nodiscard]] double coarse_loss(const TreeRays& rays) const;
  [[nodiscard]] bool builds_coarsely(const TreeRays& rays) const;
  [[nodiscard]] bool builds_finely(const TreeRays& rays) const;

  Costs costs_;
  std::uint32_t triangles_ = 0;
  Joining joining_ = Joining::kNone;
  bool built_ = false;   ///< a tree of these triangles exists, for these or former positions
  bool moved_ = false;   ///< the tree is for former positions
  bool fine_ = false;    ///< built by surface area
  bool coarse_ = false;  ///< built with large leaves
  float cost_when_built_ = 0;
  bool degraded_ = false;
  double coarse_loss_ = 0;  ///< of all rays since the coarse tree was built, less what refits saved
  std::uint32_t moves_ = 0;                 ///< since the triangles were replaced
  std::uint32_t patience_ = 2;              ///< moves before a fine tree is attempted
  std::uint64_t rays_since_change_ = 0;     ///< traced through the tree, as rays by themselves
  std::uint64_t rays_between_changes_ = 0;  ///< the same, between the last two changes
};

/// How rays traverse the tree.
struct RayPlan {
  Coherence found;
  bool of_batch = true;  ///< `found` is on the scale of the batch's extent, not of the scene's
  Bundle bundle = Bundle::kStream;
  std::size_t row = 0;  ///< rays per row, if the batch is an image (queries/ray_samples.h); or 0
};

[[nodiscard]] RayPlan plan_rays(const RaySource& rays, const Box* whole = nullptr);

/// How the stages (taking, ordering and tracing rays) follow each other.
enum class Stages : std::uint8_t {
  kWhole,  ///< each for the whole batch
  kFew,    ///< few rays, each by itself, whatever they are
  kTiles,  ///< all for a tile (queries/ray_tiles.h), then for the next
  kCopies  ///< for copies in the order of quarters (queries/quartered_rays.h)
};

struct Plan {
  TreePlan tree;
  RayPlan rays;
  Stages stages = Stages::kWhole;
};

/// Choices that are made for the plan, so that they can be measured against it.
struct GivenChoices {
  std::optional<bool> few;
  std::optional<Bundle> bundle;
  std::optional<bool> tiles;
  std::optional<TreeWork> tree;
};

/// Whether the rays go one by one: any up to 64, and up to 512 that are not coherent enough for
/// streams.
[[nodiscard]] bool are_few(const RaySource& rays);

/// `any`: an any-hit query. `given` replaces the plan's own choices.
[[nodiscard]] Plan make_plan(const SceneHistory& scene, const RaySource& rays, bool any,
                             const GivenChoices& given = {});

/// A sentence for each choice, with the numbers that decided it.
[[nodiscard]] std::vector<std::string> explain(const TreePlan& plan);
[[nodiscard]] std::vector<std::string> explain(const RayPlan& plan);
[[nodiscard]] std::vector<std::string> explain(const Plan& plan);

}  // namespace raysheaf
