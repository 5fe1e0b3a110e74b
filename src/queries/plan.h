// The cost model: chooses how a query is answered from its rays and its scene, and states the
// reasons.
//
// Costs are nanoseconds of one core, measured on one machine (docs/performance.md); only their
// proportions matter, which differ little between machines. All decisions depend only on the
// query's arguments, the scene's history and its tree, so that the same calls make the same choices
// with any number of threads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "methods/dual/dual.h"
#include "queries/query_report.h"
#include "rays/ray_source.h"

namespace raysheaf {

/// The coherence of neighbouring rays, from a sample.
struct Coherence {
  double origin = 0;     ///< median extent of sixteen rays' origins, as a fraction of the whole
                         ///< extent
  double direction = 0;  ///< fraction of groups of sixteen whose rays point towards one quarter
                         ///< with similar slopes

  [[nodiscard]] bool origins_alike() const { return origin < 0.2; }
  [[nodiscard]] bool directions_alike() const { return direction > 0.7; }
  /// With fewer coherent neighbours, more rays must be sorted into a stream for it to have some
  /// that go one way (`raysheaf bench plan`).
  [[nodiscard]] bool in_streams() const { return origins_alike() && direction > 0.33; }
};

/// `whole`: the box that contains all origins; null: the batch's own extent. O(1): samples the
/// rays. Invalid rays do no harm.
[[nodiscard]] Coherence sample_coherence(const RaySource& rays, const Box* whole = nullptr);

/// A tree whose expected cost has grown by this factor since it was built is not refitted again.
inline constexpr float kSpoilt = 1.5f;

/// The rays for which a tree is prepared.
struct TreeRays {
  std::uint64_t count = 0;  ///< 0: unknown
  bool together = false;    ///< any-hit rays that traverse the tree in streams
};

/// The history of the scene.
struct SceneHistory {
  std::uint32_t triangles = 0;
  Joining joining = Joining::kNone;  ///< of a rebuild, which is faster if triangles are joined
  bool built = false;       ///< a tree of these triangles exists, for these or for former positions
  bool moved = false;       ///< the tree is for former positions
  bool fine = false;        ///< built by surface area
  bool coarse = false;      ///< built with large leaves
  double coarse_loss = 0;   ///< of all rays since then
  bool degraded = false;    ///< refits have made the tree much worse than when it was built
  bool keep_flat = false;   ///< areas of triangles come and go: the tree holds those without one
  std::uint32_t moves = 0;  ///< since the triangles were last replaced
  std::uint32_t patience = 2;              ///< moves before a fine tree is attempted
  std::uint64_t rays_since_change = 0;     ///< `rays_alone` that were traced through the tree
  std::uint64_t rays_between_changes = 0;  ///< the same, between the last two changes

  /// The history after the triangles were replaced.
  [[nodiscard]] SceneHistory replaced(std::uint32_t new_triangles) const;
  /// Records that these rays are traced through the tree.
  void trace(const TreeRays& rays);
  /// Records that the tree was refitted.
  void refit();
  /// Records that the same triangles moved.
  void move();
  /// Records that a fine tree was of no use, because refits degraded it or because it was given up
  /// before it was complete: the next attempt waits longer.
  void wait_longer();
};

/// The number of rays that would take as long if each traversed the tree on its own.
[[nodiscard]] std::uint64_t rays_alone(const TreeRays& rays);

/// The time that a fine tree may take from a query of these rays, in nanoseconds of one core.
[[nodiscard]] double slice_of(const SceneHistory& scene, const TreeRays& rays);

/// The time that rays lose in a tree with large leaves, in nanoseconds of one core.
[[nodiscard]] double coarse_loss(const SceneHistory& scene, const TreeRays& rays);

struct Plan {
  TreeWork tree = TreeWork::kKeep;
  /// A fine tree is built in addition to this one: each query may add `slice_ns` of one core to the
  /// time that it takes, so that no query takes much longer than the others.
  bool finely = false;
  double slice_ns = 0;
  TreeRays rays;       ///< for which the tree is prepared
  bool alike = false;  ///< neighbouring rays start close together and are coherent
  Bundle bundle = Bundle::kStream;
  std::size_t row = 0;               ///< rays per row, if the batch is an image
                                     ///< (queries/picture_rows.h); or 0
  std::vector<std::string> reasons;  ///< one sentence for each choice
};

/// Choices that are made for the plan, so that they can be measured against it.
struct GivenChoices {
  std::optional<Bundle> bundle;
  std::optional<bool> alike;  ///< false: not in tiles
  std::optional<TreeWork> tree;
};

/// `any`: an any-hit query. `explain`: write the reasons. `given` replaces the plan's own choices.
[[nodiscard]] Plan make_plan(const SceneHistory& scene, const RaySource& rays, bool any,
                             bool explain, const GivenChoices& given = {});

/// The two halves of `make_plan`: how the tree is prepared for rays, and how a small part of many
/// rays traverses it, for triangles in the box `whole`.
[[nodiscard]] Plan plan_tree(const SceneHistory& scene, const TreeRays& rays, bool explain);
[[nodiscard]] Plan plan_rays(const RaySource& rays, const Box& whole, bool explain);

}  // namespace raysheaf
