#include "queries/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "base/vec.h"
#include "methods/dual/ray_order.h"
#include "queries/picture_rows.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

// Costs in nanoseconds of one core.
constexpr double kRefitTriangle = 20, kFineTriangle = 500;
constexpr double kRebuildTriangle[] = {52, 40, 29};  // by `Joining`
// A refit's cost per triangle: what a fine tree costs more than a quick one, and what a coarse one
// costs less, by `Joining`.
constexpr double kFineRefits[] = {4, 8, 13}, kCoarseRefits[] = {8, 4, 2};
constexpr double kRebuild = 1e6;  // independent of the triangles
// A coarse tree saves this per triangle, by `Joining`, and loses this per ray times the root of the
// number of triangles per ray: the first for any-hit rays with coherent neighbours, which together
// miss most of a large leaf.
constexpr double kCoarseSaves[] = {20, 14, 14};
constexpr double kCoarseRayTogether = 9, kCoarseRay = 30;
constexpr double kTraceRayLevel = 7;    // per ray and doubling of the triangles
constexpr std::uint64_t kTogether = 4;  // any-hit rays that together take as long as one by itself

/// The fraction of the tracing time that a fine tree saves, by `Joining`: joined leaves are of one
/// size, as fine as they can be, and their quads are fuller.
constexpr double kFineSaves[] = {0.1, 0.1, 0};

/// The part of a query's time that it may spend on a fine tree.
constexpr double kFineSlice = 0.2;

constexpr std::size_t kGroups = 64, kFewestGroups = 8;

std::string figures(const char* format, double a, double b = 0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

/// The longest side, in binary64, where that of any box is finite.
double extent(Vec3 low, Vec3 high) {
  const double x = static_cast<double>(high.x) - low.x, y = static_cast<double>(high.y) - low.y;
  return std::max({x, y, static_cast<double>(high.z) - low.z});
}

/// The time that rays take in the tree, each by itself.
double trace_cost(const SceneHistory& scene, std::uint64_t rays) {
  return static_cast<double>(rays) * kTraceRayLevel * std::log2(2.0 + scene.triangles);
}

/// The time that these rays save in a fine tree.
double fine_gain(const SceneHistory& scene, std::uint64_t rays) {
  return kFineSaves[static_cast<int>(scene.joining)] * trace_cost(scene, rays);
}

bool tries_fine_tree(const SceneHistory& scene) {
  return fine_gain(scene, scene.rays_since_change) > kFineTriangle * scene.triangles;
}

/// Whether a fine tree that is refitted from now on saves more than its refits cost in addition: it
/// has fewer triangles per quad.
bool refits_finely(const SceneHistory& scene, const TreeRays& rays) {
  if (scene.moves < scene.patience) return false;
  const double gain = fine_gain(scene, scene.rays_between_changes);
  const double cost = kFineRefits[static_cast<int>(scene.joining)] * scene.triangles;
  // A coarse tree has the cheapest refits, and loses in the rays.
  const double more = kCoarseRefits[static_cast<int>(scene.joining)] * scene.triangles;
  return gain > cost && (!scene.coarse || gain + coarse_loss(scene, rays) > cost + more);
}

double coarse_tree_saves(const SceneHistory& scene) {
  return kCoarseSaves[static_cast<int>(scene.joining)] * scene.triangles;
}

/// Whether a coarse tree is the faster choice for these rays, and for those by which they were more
/// between the last two changes.
bool builds_coarsely(const SceneHistory& scene, const TreeRays& rays) {
  const std::uint64_t alone = rays_alone(rays);
  const std::uint64_t others = std::max(scene.rays_between_changes, alone) - alone;
  const double lost = coarse_loss(scene, rays) + coarse_loss(scene, {others, false});
  return lost > 0 && lost < coarse_tree_saves(scene);
}

double rebuild_cost(const SceneHistory& scene) {
  return kRebuild + kRebuildTriangle[static_cast<int>(scene.joining)] * scene.triangles;
}

/// Whether rays have lost as much in the large leaves as a new tree costs.
bool outgrew_coarse_tree(const SceneHistory& scene) {
  return scene.coarse && scene.coarse_loss > rebuild_cost(scene);
}

/// Why a fine tree will pay; null if it will not, or if the tree is one.
const char* reason_for_fine_tree(const SceneHistory& scene, const TreeRays& rays) {
  if (scene.fine) return nullptr;
  if (!scene.moved)
    return tries_fine_tree(scene) ? "so many rays have met triangles that do not move" : nullptr;
  return refits_finely(scene, rays) ? "the same triangles keep moving" : nullptr;
}

void choose_tree(const SceneHistory& scene, const TreeRays& rays, Plan* plan) {
  const auto choose = [&](TreeWork work, std::string reason) {
    plan->tree = work;
    plan->reasons.push_back(std::move(reason));
  };
  const auto rebuild = [&](const std::string& reason) {
    if (builds_coarsely(scene, rays))
      return choose(TreeWork::kRebuildCoarsely,
                    reason + "; with large leaves, because they are many for these rays");
    choose(TreeWork::kRebuild, reason);
  };
  if (!scene.built) return rebuild("object tree: built, because these triangles are new");
  if (scene.degraded) return rebuild("object tree: built again, because moves have degraded it");
  if (outgrew_coarse_tree(scene))
    return choose(TreeWork::kRebuild,
                  "object tree: built again with small leaves, because so many rays have met these "
                  "triangles");
  if (const char* const reason = reason_for_fine_tree(scene, rays)) {
    plan->finely = true;
    plan->slice_ns = slice_of(scene, rays);
    plan->reasons.push_back(
        std::string("fine object tree: a slice of it is built at each query, because ") + reason);
  }
  if (!scene.moved)
    return choose(TreeWork::kKeep, "object tree: kept, because no triangle has moved");
  choose(TreeWork::kRefit, "object tree: refitted, because the same triangles have moved");
}

void choose_bundle(const RaySource& rays, const Box* whole, bool explain, Plan* plan) {
  const Coherence found = sample_coherence(rays, whole);
  const bool together = found.origins_alike();
  plan->alike = together && found.directions_alike();
  plan->bundle = found.in_streams() ? Bundle::kStream : Bundle::kLongStream;
  if (plan->alike) plan->row = find_picture_row(rays);
  if (!explain) return;
  const std::string extent = whole != nullptr ? "scene's extent" : "batch's extent";
  plan->reasons.push_back(
      together
          ? figures("rays: sixteen in a row start within %.2g %% of the ", 100 * found.origin) +
                extent
          : figures("rays: sixteen in a row start %.0f %% of the ", 100 * found.origin) + extent +
                " apart");
  const double alike = together ? 100 * found.direction : 0;
  plan->reasons.push_back(
      figures(plan->bundle == Bundle::kStream
                  ? "bundles: streams, because %.0f %% of neighbours are coherent"
                  : "bundles: long streams, because only %.0f %% of neighbours are coherent",
              alike));
  if (plan->row == 0) return;
  plan->reasons.push_back(
      figures("order: tiles of four by four, because rows of %.0f rays are adjacent",
              static_cast<double>(plan->row)));
}

}  // namespace

std::uint64_t rays_alone(const TreeRays& rays) {
  return rays.together ? rays.count / kTogether : rays.count;
}

double slice_of(const SceneHistory& scene, const TreeRays& rays) {
  const double refit = scene.moved ? kRefitTriangle * scene.triangles : 0;
  return kFineSlice * (trace_cost(scene, rays_alone(rays)) + refit);
}

double coarse_loss(const SceneHistory& scene, const TreeRays& rays) {
  return (rays.together ? kCoarseRayTogether : kCoarseRay) *
         std::sqrt(static_cast<double>(scene.triangles) * static_cast<double>(rays.count));
}

SceneHistory SceneHistory::replaced(std::uint32_t new_triangles) const {
  SceneHistory fresh;
  fresh.triangles = new_triangles;
  fresh.rays_between_changes = rays_since_change;
  return fresh;
}

void SceneHistory::trace(const TreeRays& rays) {
  rays_since_change += rays_alone(rays);
  if (coarse) coarse_loss += raysheaf::coarse_loss(*this, rays);
}

void SceneHistory::refit() {
  if (!coarse) return;
  const double saved = kCoarseRefits[static_cast<int>(joining)] * triangles;
  coarse_loss = std::max(0.0, coarse_loss - saved);
}

void SceneHistory::move() {
  rays_between_changes = rays_since_change;
  rays_since_change = 0;
  moved = true;
  ++moves;
}

void SceneHistory::wait_longer() {
  constexpr std::uint64_t kLongest = std::numeric_limits<std::uint32_t>::max();
  patience = static_cast<std::uint32_t>(std::min(kLongest, moves + std::uint64_t{2} * patience));
}

namespace {

/// Where a sampled group begins in its part of the batch, from 0 to `most`, by a hash (M. O'Neill,
/// "PCG", 2014): at equal distances, all groups of an image could lie in one column.
std::size_t offset_of_group(std::size_t group, std::size_t most) {
  constexpr std::uint32_t kSeed = 14 * 64;  // spreads well over images 128 to 1920 pixels wide
  const std::uint32_t state =
      (kSeed + static_cast<std::uint32_t>(group)) * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
  return static_cast<std::size_t>(std::uint64_t{(word >> 22) ^ word} * most >> 32);
}

}  // namespace

Coherence sample_coherence(const RaySource& rays, const Box* whole) {
  constexpr std::size_t kGroup = 16;
  // Fewer groups for a small batch: sampling it must cost less than tracing it.
  const std::size_t groups =
      std::min({kGroups, rays.size() / kGroup, kFewestGroups + rays.size() / 512});
  if (groups == 0) return {};
  const std::size_t stride = rays.size() / groups;
  Vec3 low, high;
  std::array<double, kGroups> extents{};
  double alike = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    Vec3 o0, o1, d0, d1;
    std::uint32_t first = 0, same = 0;
    std::array<Ray, kGroup> room;
    const std::size_t begin = g * stride + offset_of_group(g, stride - kGroup);
    const View<const Ray> group = rays.peek(begin, begin + kGroup, room.data());
    for (std::size_t i = 0; i < kGroup; ++i) {
      const Ray& ray = group[i];
      const Vec3 d = ray.direction / max_component(abs(ray.direction));
      if (i == 0) first = quarter_of(d);
      same += quarter_of(d) == first ? 1 : 0;
      o0 = i == 0 ? ray.origin : min(o0, ray.origin);
      o1 = i == 0 ? ray.origin : max(o1, ray.origin);
      d0 = i == 0 ? d : min(d0, d);
      d1 = i == 0 ? d : max(d1, d);
    }
    low = g == 0 ? o0 : min(low, o0);
    high = g == 0 ? o1 : max(high, o1);
    extents[g] = extent(o0, o1);
    if (std::isnan(extents[g])) extents[g] = 0;
    alike += same == kGroup && max_component(d1 - d0) < 0.5f ? 1 : 0;
  }
  // The median, because a silhouette between neighbours does not make rays incoherent.
  std::nth_element(extents.begin(), extents.begin() + groups / 2, extents.begin() + groups);
  const double size = whole != nullptr ? extent(whole->min, whole->max) : extent(low, high);
  return {size > 0 ? extents[groups / 2] / size : 0, alike / static_cast<double>(groups)};
}

Plan make_plan(const SceneHistory& scene, const RaySource& rays, bool any, bool explain,
               const GivenChoices& given) {
  Plan bundles;
  choose_bundle(rays, nullptr, explain, &bundles);
  const bool together = any && bundles.bundle == Bundle::kStream;
  Plan plan = plan_tree(scene, {rays.size(), together}, explain);
  plan.bundle = given.bundle.value_or(bundles.bundle);
  plan.alike = given.alike.value_or(bundles.alike);
  plan.row = bundles.row;
  plan.tree = given.tree.value_or(plan.tree);
  plan.finely = plan.finely && !given.tree.has_value();
  std::move(bundles.reasons.begin(), bundles.reasons.end(), std::back_inserter(plan.reasons));
  return plan;
}

Plan plan_tree(const SceneHistory& scene, const TreeRays& rays, bool explain) {
  Plan plan;
  choose_tree(scene, rays, &plan);
  plan.rays = rays;
  if (!explain) plan.reasons.clear();
  return plan;
}

Plan plan_rays(const RaySource& rays, const Box& whole, bool explain) {
  Plan plan;
  choose_bundle(rays, &whole, explain, &plan);
  return plan;
}

}  // namespace raysheaf
