#include "engine/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/vec.h"
#include "fan/fan.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

// Nanoseconds of one core.
constexpr double kFanRay = 25, kFanTriangle = 23;
constexpr double kRefitTriangle = 15, kRebuildTriangle = 45, kFineTriangle = 380;
constexpr double kTraceRayLevel = 7;                    // a ray, a doubling of the triangles
constexpr double kSharedRay = 20, kSharedRayLevel = 3;  // where all start at one point

/// What a fine tree saves of the tracing.
constexpr double kFineSaves = 0.1;

constexpr std::size_t kGroups = 64;

std::string figures(const char* format, double a, double b) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

/// The longest side; in binary64, where that of any box is finite.
double extent(Vec3 low, Vec3 high) {
  const double x = static_cast<double>(high.x) - low.x, y = static_cast<double>(high.y) - low.y;
  return std::max({x, y, static_cast<double>(high.z) - low.z});
}

double trace_cost(const SceneHistory& scene, double rays) {
  return rays * kTraceRayLevel * std::log2(2.0 + scene.triangles);
}

bool tries_fine_tree(const SceneHistory& scene) {
  const double gain = kFineSaves * trace_cost(scene, static_cast<double>(scene.rays_since_change));
  return gain > kFineTriangle * scene.triangles;
}

void choose_tree(const SceneHistory& scene, Plan* plan) {
  const auto choose = [&](TreeWork work, std::string reason) {
    plan->tree = work;
    plan->reasons.push_back(std::move(reason));
  };
  if (!scene.built)
    return choose(TreeWork::kRebuild, "object tree: built, for these triangles are new");
  if (!scene.moved && (!scene.fine || scene.degraded) && tries_fine_tree(scene))
    return choose(TreeWork::kRebuildFinely,
                  "object tree: built finely, for so many rays have met triangles that stay");
  if (scene.degraded)
    return choose(TreeWork::kRebuild, "object tree: built again, for moves have spoilt it");
  if (!scene.moved) return choose(TreeWork::kKeep, "object tree: kept, for no triangle has moved");
  if (!scene.fine && scene.moves >= scene.patience)
    return choose(TreeWork::kRebuildFinely,
                  "object tree: built finely, to be refitted from now on, for the same triangles "
                  "keep moving");
  choose(TreeWork::kRefit, "object tree: refitted, for the same triangles have moved");
}

/// Of the tree before rays can go through it. Queries that this scene has had without a change say
/// how many more may share it.
double tree_cost(const SceneHistory& scene) {
  if (scene.built && !scene.moved) return 0;
  const double a_triangle = scene.built && !scene.degraded ? kRefitTriangle : kRebuildTriangle;
  return a_triangle * scene.triangles / (1.0 + scene.queries_since_change);
}

/// Whether the rays fan out from a point and it pays to stream the triangles at them.
bool chooses_fan(const Executor& executor, const SceneHistory& scene, View<const Ray> rays,
                 Plan* plan) {
  // Farther out, products of the fan's differences overflow.
  if (!(max_component(abs(rays[0].origin)) <= kLargestCoordinate)) return false;
  if (!share_origin(executor, rays)) return false;
  const auto count = static_cast<double>(rays.size);
  const double fan = kFanRay * count + kFanTriangle * scene.triangles;
  const double a_ray = kSharedRay + kSharedRayLevel * std::log2(2.0 + scene.triangles);
  const double tree = tree_cost(scene) + a_ray * count;
  const bool chosen = fan < tree;
  plan->reasons.push_back(figures(
      chosen ? "rays of one origin: triangles stream against cells over them, about %.2g ms "
               "of a core; an object tree about %.2g"
             : "rays of one origin, but streaming the triangles is about %.2g ms of a core, "
               "the object tree %.2g",
      fan * 1e-6, tree * 1e-6));
  return chosen;
}

/// Below, boxes and triangles stay in the caches whatever the order.
constexpr std::uint32_t kSortTriangles = 50000;

void choose_bundle(const SceneHistory& scene, View<const Ray> rays, Plan* plan) {
  const Coherence found = sample_coherence(rays, nullptr);
  plan->sort = !found.origins_alike() && scene.triangles >= kSortTriangles;
  plan->reasons.push_back(figures(
      !plan->sort && !found.origins_alike()
          ? "rays: not sorted, though sixteen in a row start %.0f %% of the batch's extent apart: "
            "the scene is small"
      : plan->sort
          ? "rays: sorted, for sixteen in a row start %.0f %% of the batch's extent apart"
          : "rays: not sorted, for sixteen in a row start within %.2g %% of the batch's extent",
      100 * found.origin, 0));
  const bool alike = found.origins_alike() && found.directions_alike();
  plan->bundle = alike ? Bundle::kPacket : Bundle::kStream;
  if (!found.origins_alike()) {
    plan->reasons.emplace_back("bundles: streams, for neighbours start apart");
    return;
  }
  plan->reasons.push_back(figures(
      alike ? "bundles: packets of sixteen within beams, for %.0f %% of neighbours run alike"
            : "bundles: streams, for only %.0f %% of neighbours run alike",
      100 * found.direction, 0));
}

}  // namespace

Coherence sample_coherence(View<const Ray> rays, const std::uint32_t* order) {
  constexpr std::size_t kGroup = 16;
  const std::size_t groups = std::min(kGroups, rays.size / kGroup);
  if (groups == 0) return {};
  const std::size_t stride = rays.size / groups;
  Vec3 low, high;
  std::array<double, kGroups> extents{};
  double alike = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    Vec3 o0, o1, d0, d1;
    std::uint32_t first = 0, same = 0;
    for (std::size_t i = 0; i < kGroup; ++i) {
      const std::size_t place = g * stride + i;
      const Ray& ray = rays[order != nullptr ? order[place] : place];
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
    alike += same == kGroup && max_component(d1 - d0) < 0.5f ? 1 : 0;
  }
  // The middle one: a silhouette between neighbours is no sign of disorder.
  std::nth_element(extents.begin(), extents.begin() + groups / 2, extents.begin() + groups);
  const double whole = extent(low, high);
  return {whole > 0 ? extents[groups / 2] / whole : 0, alike / static_cast<double>(groups)};
}

Plan make_plan(const Executor& executor, const SceneHistory& scene, View<const Ray> rays, bool any,
               bool explain) {
  Plan plan;
  plan.fan = any && chooses_fan(executor, scene, rays, &plan);
  if (!plan.fan) {
    choose_tree(scene, &plan);
    choose_bundle(scene, rays, &plan);
  }
  if (!explain) plan.reasons.clear();
  return plan;
}

}  // namespace raysheaf
