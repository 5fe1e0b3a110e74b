// Checks that bounds do not lose hits: bundles of the ray hierarchy one by one, all other bounds by
// rays that can only have a single hit.
#include <algorithm>
#include <numeric>
#include <optional>

#include "exec/progress_meter.h"
#include "lab/verify/round.h"
#include "lab/verify/simd_target.h"
#include "lab/verify/soup.h"
#include "paper/base/flat_arrays.h"
#include "paper/packets/packet_traverse.h"
#include "paper/ray_hierarchy/hierarchy.h"
#include "paper/ray_hierarchy/node_test.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint32_t kBoundTriangles = 160;
constexpr std::size_t kRays = 512;
constexpr std::uint32_t kBranching = 4, kLevels = 3;

struct Pair {
  std::uint32_t ray, triangle;
  float t;
};

struct Situation {
  Soup soup;
  std::vector<Ray> rays;
  SceneDescription description;
  FlatScene flat;
  std::optional<FlatArrays> arrays;  ///< of `flat`
  TriangleView triangles;            ///< of `arrays`
  std::vector<Pair> hits;            ///< all hits

  [[nodiscard]] bool meets(const Ray& ray, std::uint32_t triangle, TriangleHit* hit) const {
    return intersect_triangle(make_ray_setup(ray), triangles.corner(triangle, 0),
                              triangles.corner(triangle, 1), triangles.corner(triangle, 2), hit);
  }
};

Situation make_situation(const Executor& executor, Random* random) {
  Situation s;
  s.soup = make_soup(kBoundTriangles, {}, random);
  s.rays = random->one_in(3) ? make_fan(s.soup, kRays, random) : make_rays(s.soup, kRays, random);
  if (random->one_in(2)) {  // leaves of one ray have the tightest bounds
    for (std::size_t i = 0; i < kRays; ++i) s.rays[i] = s.rays[i - i % kBranching];
  }
  s.description = s.soup.description();
  s.flat = flatten(executor, s.description, mesh_bounds(executor, s.description));
  s.arrays.emplace(executor, s.flat);
  s.triangles = s.arrays->view();
  TriangleHit hit;
  for (std::uint32_t i = 0; i < kRays; ++i)
    for (std::uint32_t k = 0; k < s.flat.triangle_count; ++k)
      if (s.meets(s.rays[i], k, &hit)) s.hits.push_back({i, k, hit.t});
  return s;
}

std::string lost(const Situation& s, const Pair& pair) {
  return s.soup.text() + ", a " + text_of(s.rays[pair.ray]) + " loses triangle " +
         std::to_string(pair.triangle) + ", which it hits";
}

/// Finds the triangles that each node of a level accepts, and checks that it accepts all meshes
/// that it must.
template <class Bound>
void check_level(const Situation& s, const std::vector<Bound>& nodes, std::uint32_t width,
                 const std::string& name, Tally* tally) {
  const std::uint32_t count = s.flat.triangle_count;
  const auto fields = fields_of<NodeTest<Bound>>(s.triangles);
  std::vector<std::uint32_t> out(count + kTriangleBlock);
  std::vector<std::uint8_t> met(count);
  std::size_t next = 0;
  for (std::uint32_t node = 0; node < nodes.size(); ++node) {
    const auto test = make_node_test(nodes[node]);
    std::fill(met.begin(), met.end(), std::uint8_t{0});
    const std::uint32_t found = filter(test, fields, count, out.data());
    for (std::uint32_t i = 0; i < found; ++i) met[out[i]] = 1;
    for (; next < s.hits.size() && s.hits[next].ray < (node + 1) * width; ++next) {
      const Pair& pair = s.hits[next];
      const FlatMesh& mesh = s.flat.meshes[s.flat.mesh_of_triangle[pair.triangle]];
      if (met[pair.triangle] != 0 && meets_mesh(test, mesh)) continue;
      tally->fail(name + ", nodes of " + std::to_string(width) + " rays: " + lost(s, pair));
    }
  }
  tally->tried(s.hits.size());
}

void check_bundles(const Situation& s, const Executor& executor, std::int64_t target,
                   Tally* tally) {
  for (const BundleBound bound :
       {BundleBound::kSphereCone, BundleBound::kFiniteCone, BundleBound::kShaft,
        BundleBound::kFrustum, BundleBound::kShaftAndCone}) {
    with_bound(bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
      const auto tree =
          build_hierarchy<Bound>(executor, s.rays, s.flat.bounds, kBranching, kLevels);
      std::uint32_t width = 1;
      for (std::uint32_t level = 1; level <= kLevels; ++level) {
        width *= kBranching;
        check_level(s, tree.level(level), width,
                    std::string(to_string(bound)) + " on " + name_of(target), tally);
      }
    });
  }
}

/// A ray for each of some hits, whose interval is only the hit's t.
std::vector<Ray> rays_of_one_hit(const Situation& s, std::vector<Pair>* pairs) {
  std::vector<Ray> rays;
  for (const Pair& pair : *pairs) {
    rays.push_back(s.rays[pair.ray]);
    rays.back().t_min = rays.back().t_max = pair.t;
  }
  return rays;
}

template <class IsMet>
void expect_all_met(const Situation& s, const std::vector<Pair>& pairs, const std::string& who,
                    const IsMet& is_met, Tally* tally) {
  tally->tried(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!is_met(i)) return tally->fail(who + ": " + lost(s, pairs[i]));
}

/// Checks the trees and beams of the library, and the frusta of `gl10`.
void check_single_hits(const Situation& s, const Subject& subject, const Subject::Threads& threads,
                       std::int64_t target, Tally* tally) {
  std::vector<Pair> pairs = s.hits;
  // Scenes contain no triangles without area.
  const std::vector<Ray> rays = rays_of_one_hit(s, &pairs);
  Scene scene(threads.context);
  s.soup.add_to(&scene);
  const std::string on = " of dual on " + name_of(target);
  const std::vector<Hit> closest = subject.closest_hit(scene, rays, {});
  expect_all_met(
      s, pairs, "closest_hit" + on, [&](std::size_t i) { return closest[i].prim_id != kInvalidId; },
      tally);
  const std::vector<std::uint8_t> any = subject.any_hit(scene, rays, {});
  expect_all_met(
      s, pairs, "any_hit" + on, [&](std::size_t i) { return any[i] != 0; }, tally);
  const HitRows all = subject.all_hits(scene, rays, {});
  expect_all_met(
      s, pairs, "all_hits" + on, [&](std::size_t i) { return !all[i].empty(); }, tally);

  const Executor& executor = *threads.executor;
  std::vector<std::uint32_t> order(rays.size());
  std::iota(order.begin(), order.end(), 0u);
  const std::vector<Packet> packets = make_packets(executor, rays, {}, 32, kPacketRays, order);
  std::vector<Ray> ordered;
  for (const std::uint32_t i : order) ordered.push_back(rays[i]);
  std::vector<RayHit> best(rays.size());
  ProgressMeter meter;
  traverse_packets(executor, s.triangles, build_bvh(executor, s.triangles), packets, ordered, {},
                   best, {}, &meter);
  std::vector<Pair> ordered_pairs;
  for (const std::uint32_t i : order) ordered_pairs.push_back(pairs[i]);
  expect_all_met(
      s, ordered_pairs, "frusta of gl10 on " + name_of(target),
      [&](std::size_t i) { return best[i].found(); }, tally);
}

}  // namespace

void check_bounds(const Subject& subject, std::uint64_t seed, Tally* tally) {
  Random random(seed);
  const Subject::Threads& threads = subject.most();
  const Situation s = make_situation(*threads.executor, &random);
  if (s.hits.empty()) return;
  for (const std::int64_t target : subject.targets) {
    const OnSimdTarget on(target);
    check_bundles(s, *threads.executor, target, tally);
    check_single_hits(s, subject, threads, target, tally);
  }
}

}  // namespace raysheaf::checks
