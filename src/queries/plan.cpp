#include "queries/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "queries/ray_tiles.h"

namespace raysheaf {

void SceneHistory::replaced(std::uint32_t triangles, Joining joining) {
  SceneHistory fresh(costs_);
  fresh.triangles_ = triangles;
  fresh.joining_ = joining;
  fresh.rays_between_changes_ = rays_since_change_;
  *this = fresh;
}

void SceneHistory::moved() {
  rays_between_changes_ = std::exchange(rays_since_change_, 0);
  moved_ = true;
  ++moves_;
}

void SceneHistory::tree_was(TreeWork work, float cost) {
  if (work == TreeWork::kRefit) {
    if (coarse_)
      coarse_loss_ = std::max(0.0, coarse_loss_ - of(costs_.coarse_refit_saves) * triangles_);
  } else if (work != TreeWork::kKeep) {
    if (fine_ && work != TreeWork::kRebuildFinely) fine_tree_was_given_up();
    fine_ = work == TreeWork::kRebuildFinely;
    coarse_ = work == TreeWork::kRebuildCoarsely;
    coarse_loss_ = 0;
    cost_when_built_ = cost;
  }
  built_ = true;
  moved_ = false;
  degraded_ = cost > kSpoilt * cost_when_built_;
}

void SceneHistory::fine_tree_was_given_up() {
  constexpr std::uint64_t kLongest = std::numeric_limits<std::uint32_t>::max();
  patience_ = static_cast<std::uint32_t>(std::min(kLongest, moves_ + std::uint64_t{2} * patience_));
}

void SceneHistory::traced(const TreeRays& rays) {
  rays_since_change_ += alone(rays);
  if (coarse_) coarse_loss_ += coarse_loss(rays);
}

double SceneHistory::of(const Costs::ByJoining& cost) const {
  return cost[static_cast<std::size_t>(joining_)];
}

std::uint64_t SceneHistory::alone(const TreeRays& rays) const {
  return rays.together ? rays.count / costs_.together : rays.count;
}

double SceneHistory::trace_time(std::uint64_t rays) const {
  return static_cast<double>(rays) * costs_.ray_level * std::log2(2.0 + triangles_);
}

double SceneHistory::fine_gain(std::uint64_t rays) const {
  return of(costs_.fine_saves) * trace_time(rays);
}

double SceneHistory::coarse_loss(const TreeRays& rays) const {
  return (rays.together ? costs_.coarse_ray_together : costs_.coarse_ray) *
         std::sqrt(static_cast<double>(triangles_) * static_cast<double>(rays.count));
}

double SceneHistory::slice(const TreeRays& rays) const {
  constexpr double kPart = 0.2;  // of the query's time
  return kPart * trace_time(alone(rays));
}

/// Whether large leaves are faster for these rays, and for those by which they were more between
/// the last two changes.
bool SceneHistory::builds_coarsely(const TreeRays& rays) const {
  const std::uint64_t here = alone(rays), others = std::max(rays_between_changes_, here) - here;
  const double lost = coarse_loss(rays) + coarse_loss({others, false});
  return lost > 0 && lost < of(costs_.coarse_build_saves) * triangles_;
}

/// Whether a fine tree saves more in rays than its build, or its refits from now on, cost.
bool SceneHistory::builds_finely(const TreeRays& rays) const {
  if (fine_) return false;
  if (!moved_) return fine_gain(rays_since_change_) > costs_.fine_build * triangles_;
  if (moves_ < patience_) return false;
  const double gain = fine_gain(rays_between_changes_), cost = costs_.fine_refit_adds * triangles_;
  // A coarse tree has the cheapest refits, and loses in the rays.
  return gain > cost &&
         (!coarse_ || gain + coarse_loss(rays) > cost + of(costs_.coarse_refit_saves) * triangles_);
}

TreePlan SceneHistory::plan(const TreeRays& rays) const {
  const auto rebuild = [&](TreeReason reason) {
    return TreePlan{builds_coarsely(rays) ? TreeWork::kRebuildCoarsely : TreeWork::kRebuild, reason,
                    false, rays};
  };
  if (!built_) return rebuild(TreeReason::kNew);
  if (degraded_) return rebuild(TreeReason::kDegraded);
  const double build = costs_.build * triangles_;
  const bool outgrown = coarse_ && coarse_loss_ > build;
  // A fine tree, in slices, spares this query a whole build. Where triangles move, its refits would
  // cost more than they save.
  const bool in_slices =
      !moved_ && rays.count != 0 && build > slice(rays) && of(costs_.fine_saves) > 0;
  if (outgrown && !in_slices) return {TreeWork::kRebuild, TreeReason::kOutgrown, false, rays};
  const bool finely = outgrown || builds_finely(rays);
  return moved_ ? TreePlan{TreeWork::kRefit, TreeReason::kMoved, finely, rays}
                : TreePlan{TreeWork::kKeep, TreeReason::kUnmoved, finely, rays};
}

RayPlan plan_rays(const RaySource& rays, const Box* whole) {
  RayPlan plan{sample_coherence(rays, whole), whole == nullptr};
  if (!plan.found.in_streams()) plan.bundle = Bundle::kLongStream;
  if (plan.found.alike()) plan.row = find_picture_row(rays);
  return plan;
}

bool are_few(const RaySource& rays) {
  constexpr std::size_t kAlways = 64, kIncoherent = 512;
  return rays.size() <= kAlways ||
         (rays.size() <= kIncoherent && !sample_coherence(rays).in_streams());
}

Plan make_plan(const SceneHistory& scene, const RaySource& rays, bool any,
               const GivenChoices& given) {
  // Occlusion is a byte per ray: copies of up to this many rays in the order of their quarters cost
  // more than reading the rays where they are.
  constexpr std::size_t kMostReadInPlace = std::size_t{1} << 18;
  Plan plan;
  const bool streams = given.bundle.has_value() || given.tiles.has_value();
  const bool few = given.few.has_value() ? *given.few : !streams && are_few(rays);
  if (few) plan.stages = Stages::kFew;
  if (!few) plan.rays = plan_rays(rays);
  plan.tree = scene.plan({rays.size(), any && !few && plan.rays.bundle == Bundle::kStream});
  plan.rays.bundle = given.bundle.value_or(plan.rays.bundle);
  if (given.tree.has_value()) {
    plan.tree.work = *given.tree;
    plan.tree.finely = false;
  }
  if (few) return plan;
  // With long streams, a tile has too few rays that traverse the tree together.
  if (given.tiles.value_or(plan.rays.found.alike())) {
    plan.stages = Stages::kTiles;
  } else if (plan.rays.bundle == Bundle::kLongStream && !(any && rays.size() <= kMostReadInPlace)) {
    plan.stages = Stages::kCopies;
  }
  return plan;
}

namespace {

std::string figures(const char* format, double number) {
  char text[160];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

constexpr const char* kTreeSentences[] = {
    // By `TreeReason`.
    "object tree: built, because these triangles are new",
    "object tree: built again, because moves have degraded it",
    "object tree: built again with small leaves, because so many rays have met these triangles",
    "object tree: refitted, because the same triangles have moved",
    "object tree: kept, because no triangle has moved"};

}  // namespace

std::vector<std::string> explain(const TreePlan& plan) {
  std::vector<std::string> all;
  if (plan.work == TreeWork::kRebuildFinely) {
    all.emplace_back("object tree: built finely, in slices");
  } else {
    if (plan.finely)
      all.push_back(
          std::string("fine object tree: a slice of it is built at each query, because ") +
          (plan.reason == TreeReason::kMoved ? "the same triangles keep moving"
                                             : "so many rays have met triangles that do not move"));
    all.emplace_back(kTreeSentences[static_cast<std::size_t>(plan.reason)]);
  }
  if (plan.work == TreeWork::kRebuildCoarsely)
    all.back() += "; with large leaves, because they are many for these rays";
  if (plan.gained_area)
    all.emplace_back(
        "object tree: built again after all, because triangles without area have gained an area");
  return all;
}

std::vector<std::string> explain(const RayPlan& plan) {
  const bool together = plan.found.origins_alike(), stream = plan.bundle == Bundle::kStream;
  const std::string scale = plan.of_batch ? "batch's extent" : "scene's extent";
  std::vector<std::string> all{
      figures(together ? "rays: sixteen in a row start within %.2g %% of the "
                       : "rays: sixteen in a row start %.0f %% of the ",
              100 * plan.found.origin) +
          scale + (together ? "" : " apart"),
      figures(stream ? "bundles: streams, because %.0f %% of neighbours are coherent"
                     : "bundles: long streams, because only %.0f %% of neighbours are coherent",
              together ? 100 * plan.found.direction : 0)};
  if (plan.row != 0)
    all.push_back(figures("order: tiles of four by four, because rows of %.0f rays are adjacent",
                          static_cast<double>(plan.row)));
  return all;
}

std::vector<std::string> explain(const Plan& plan) {
  std::vector<std::string> all = explain(plan.tree);
  if (plan.stages == Stages::kFew) {
    all.emplace_back("rays: each by itself, because they are few");
    return all;
  }
  for (std::string& sentence : explain(plan.rays)) all.push_back(std::move(sentence));
  if (plan.stages == Stages::kTiles) {
    const std::size_t rays = plan.tree.rays.count;
    all.push_back("stages: one after the other for tiles of " +
                  std::to_string(std::min(rays, ray_tile_size(rays, plan.rays.row))) +
                  " rays, because neighbours are coherent");
  }
  return all;
}

}  // namespace raysheaf
