// Every bound, tested on single nodes: no hit is lost at any level, and no bound is much looser
// than binary64 requires.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <vector>

#include "intersect/triangle_body.h"
#include "paper/base/flat_arrays.h"
#include "paper/ray_hierarchy/hierarchy.h"
#include "paper/ray_hierarchy/node_test.h"
#include "support/simd_targets.h"
#include "support/soups.h"

namespace raysheaf {
namespace {

using test::Random;
using test::SoupKind;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kTriangles = 24, kRays = 64, kBranching = 4, kLevels = 3;

const std::vector<BundleBound>& all_bounds() {
  static const std::vector<BundleBound> all{BundleBound::kSphereCone, BundleBound::kFiniteCone,
                                            BundleBound::kShaft, BundleBound::kFrustum,
                                            BundleBound::kShaftAndCone};
  return all;
}

/// How many triples (ray, node, triangle) that must meet are tested, over all kinds of soup and
/// bounds.
std::uint64_t triples_wanted() {
  return std::getenv("RAYSHEAF_LONG") != nullptr ? 10000000 : 200000;
}

struct Situation {
  SceneDescription description;
  FlatScene scene;
  std::optional<FlatArrays> arrays;  ///< of `scene`
  std::vector<Ray> rays;

  [[nodiscard]] bool meets(std::size_t ray, std::uint32_t triangle, TriangleHit* hit) const {
    const TriangleView triangles = arrays->view();
    return intersect_triangle(make_ray_setup(rays[ray]), triangles.corner(triangle, 0),
                              triangles.corner(triangle, 1), triangles.corner(triangle, 2), hit);
  }
};

/// A point of a triangle: at a corner, on an edge, or inside.
Vec3 point_of(const Situation& s, std::uint32_t i, Random& random) {
  const auto [a, b, c] = s.scene.corners(i);
  switch (random.below(4)) {
    case 0:
      return a;
    case 1:
      return lerp(b, c, random.unit());
    default:
      return lerp(lerp(a, b, random.unit()), c, random.unit());
  }
}

Vec3 point_of(const Situation& s, Random& random) {
  return point_of(s, random.below(kTriangles), random);
}

/// Rays towards points of triangles, many from points of triangles: those see triangles edge-on and
/// hit them exactly at the rays' ends.
std::vector<Ray> aimed_rays(const Situation& s, Random& random) {
  const Vec3 half = (s.scene.bounds.max - s.scene.bounds.min) * 0.5f;
  const Vec3 middle = s.scene.bounds.min + half;
  const float spread = std::pow(10.0f, random.between(-6, 0.3f)) * float(random.below(4) != 0);
  const float away = std::pow(10.0f, random.between(-1, 3));
  const Vec3 around =
      random.below(2) == 0 ? point_of(s, random) : middle + random.in_box(away) * half;
  const bool one_target = random.below(2) == 0;
  const Vec3 target = point_of(s, random);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < kRays; ++i) {
    const Vec3 origin = around + random.in_box(spread) * half;
    const Vec3 aim = one_target ? target : point_of(s, random);
    Vec3 direction = (aim - origin) * std::pow(10.0f, random.between(-2, 2));
    if (!(max_component(abs(direction)) > 0)) direction = random.direction();
    rays.push_back({origin, 0, direction, kInfinity});
  }
  return rays;
}

/// Leaves that repeat one ray have the thinnest bounds. Half of the rays see a triangle edge-on.
std::vector<Ray> repeated_rays(const Situation& s, Random& random) {
  const Vec3 half = (s.scene.bounds.max - s.scene.bounds.min) * 0.5f;
  std::vector<Ray> rays;
  while (rays.size() < kRays) {
    const std::uint32_t i = random.below(kTriangles);
    const Vec3 p = point_of(s, i, random), q = point_of(s, i, random);
    const Vec3 origin = random.below(2) == 0
                            ? p + (p - q) * random.between(0, 3)
                            : p + random.in_box(std::pow(10.0f, random.between(-4, 1))) * half;
    Vec3 direction = q - origin;
    if (!(max_component(abs(direction)) > 0)) direction = random.direction();
    const Ray ray{origin, 0, direction, kInfinity};
    rays.insert(rays.end(), kBranching, ray);
  }
  return rays;
}

/// Ends the rays of some leaves exactly at a hit.
void end_some_rays(Situation* s, Random& random) {
  const bool whole_leaves = random.below(2) == 0;
  for (std::size_t i = 0; i < s->rays.size(); ++i) {
    if (whole_leaves ? (i / kBranching) % 2 == 0 : random.below(2) == 0) continue;
    TriangleHit hit;
    for (std::uint32_t k = random.below(kTriangles); k < kTriangles; ++k) {
      if (!s->meets(i, k, &hit)) continue;
      s->rays[i].t_max = hit.t;
      break;
    }
  }
}

Situation situation(SoupKind kind, float scale, Random& random) {
  Situation s;
  Mesh mesh;
  for (std::uint32_t i = 0; i < kTriangles; ++i) test::add_soup_triangle(&mesh, kind, random);
  for (Vec3& p : mesh.positions) p *= scale;
  test::add_mesh(&s.description, std::move(mesh));
  const Executor executor(1);
  s.scene = flatten(executor, s.description, mesh_bounds(executor, s.description));
  s.arrays.emplace(executor, s.scene);
  s.rays = random.below(2) == 0 ? aimed_rays(s, random) : repeated_rays(s, random);
  end_some_rays(&s, random);
  return s;
}

struct HitPair {
  std::uint32_t ray, triangle;
};

std::vector<HitPair> hits_of(const Situation& s) {
  std::vector<HitPair> hits;
  TriangleHit hit;
  for (std::uint32_t i = 0; i < kRays; ++i)
    for (std::uint32_t k = 0; k < kTriangles; ++k)
      if (s.meets(i, k, &hit)) hits.push_back({i, k});
  return hits;
}

/// For each node of a level: which triangles meet it.
template <class Bound>
std::vector<std::vector<bool>> met_at(const Situation& s, const std::vector<Bound>& nodes) {
  std::vector<std::vector<bool>> met;
  std::vector<std::uint32_t> out(kTriangles + 16);
  for (const Bound& bound : nodes) {
    const auto test = make_node_test(bound);
    const auto fields = fields_of<NodeTest<Bound>>(s.arrays->view());
    std::vector<bool>& flags = met.emplace_back(kTriangles);
    const std::uint32_t count = filter(test, fields, kTriangles, out.data());
    for (std::uint32_t i = 0; i < count; ++i) flags[out[i]] = true;
    if (count > 0) {
      EXPECT_TRUE(meets_mesh(test, s.scene.meshes[0]));
    }
  }
  return met;
}

template <class Bound>
std::uint64_t expect_no_hit_lost(const Situation& s, const std::vector<HitPair>& hits) {
  const auto tree =
      build_hierarchy<Bound>(Executor(1), s.rays, s.scene.bounds, kBranching, kLevels);
  std::uint32_t width = 1;
  for (std::uint32_t level = 1; level <= kLevels; ++level) {
    width *= kBranching;
    const auto met = met_at(s, tree.level(level));
    for (const HitPair& pair : hits) {
      EXPECT_TRUE(met[pair.ray / width][pair.triangle])
          << "level " << level << " ray " << pair.ray << " triangle " << pair.triangle;
    }
  }
  return kLevels * hits.size();
}

TEST(Bounds, NoHitIsLostAtAnyLevel) {
  Random random(77);
  std::uint64_t triples = 0;
  while (triples < triples_wanted()) {
    for (const SoupKind kind : test::soup_kinds()) {
      const float scale = std::pow(10.0f, random.between(-4, 4));
      const Situation s = situation(kind, scale, random);
      const std::vector<HitPair> hits = hits_of(s);
      for (const BundleBound bound : all_bounds()) {
        SCOPED_TRACE(std::string(to_string(bound)) + ", kind " +
                     std::to_string(static_cast<int>(kind)) + ", after " + std::to_string(triples));
        with_bound(bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
          triples += expect_no_hit_lost<Bound>(s, hits);
        });
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

template <class Bound>
void expect_same_on_every_target(const Situation& s) {
  const auto tree = build_hierarchy<Bound>(Executor(1), s.rays, s.scene.bounds, kBranching, 2);
  const auto fields = fields_of<NodeTest<Bound>>(s.arrays->view());
  for (const Bound& bound : tree.level(1)) {
    const auto test = make_node_test(bound);
    std::vector<std::uint32_t> expected, out(kTriangles + 16);
    for (std::uint32_t i = 0; i < kTriangles; ++i) {
      // Fewer triangles than a block are tested by scalar code.
      if (filter(test, from(fields, i), 1, out.data()) == 1) expected.push_back(i);
    }
    test::for_each_simd_target([&](const char* target) {
      out.resize(kTriangles + 16);
      out.resize(filter(test, fields, kTriangles, out.data()));
      EXPECT_EQ(out, expected) << target;
    });
  }
}

TEST(Bounds, EverySimdTargetAcceptsWhatTheScalarTestAccepts) {
  Random random(78);
  for (int round = 0; round < 10; ++round) {
    for (const SoupKind kind : test::soup_kinds()) {
      const Situation s = situation(kind, 1, random);
      for (const BundleBound bound : all_bounds()) {
        SCOPED_TRACE(to_string(bound));
        with_bound(bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
          expect_same_on_every_target<Bound>(s);
        });
      }
    }
  }
}

std::vector<Ray> loose_bundle(Random& random) {
  const Vec3 axis = random.direction(), center = random.in_box(6);
  const float spread = std::pow(10.0f, random.between(-3, -0.2f));
  const float extent = random.below(3) == 0 ? 0 : std::pow(10.0f, random.between(-2, 0.3f));
  const float t_max = random.below(2) == 0 ? kInfinity : random.between(0, 3);
  std::vector<Ray> rays;
  for (int i = 0; i < 8; ++i) {
    rays.push_back({center + random.in_box(extent), 0,
                    random.direction_near(axis, spread) * random.between(0.5f, 2), t_max});
  }
  return rays;
}

struct Moving {
  double lo[3], hi[3], lo_speed[3], hi_speed[3];
};

/// The smallest distance of a moving box from a box: the minimum of a convex function of t, by
/// golden section search.
double least_distance(const Moving& m, const Box& box) {
  const auto distance = [&](double t) {
    double most = -1e300;
    for (int i = 0; i < 3; ++i) {
      most = std::max(most, m.lo[i] + t * m.lo_speed[i] - double{component(box.max, i)});
      most = std::max(most, double{component(box.min, i)} - m.hi[i] - t * m.hi_speed[i]);
    }
    return most;
  };
  double lo = 0, hi = 1;
  for (int step = 0; step < 120; ++step) {
    const double a = lo + (hi - lo) * 0.382, b = lo + (hi - lo) * 0.618;
    (distance(a) < distance(b) ? hi : lo) = distance(a) < distance(b) ? b : a;
  }
  return std::min({distance(lo), distance(0), distance(1)});
}

Moving moving(const Shaft& s) {
  Moving m{};
  for (int i = 0; i < 3; ++i) {
    m.lo[i] = double{component(s.origins.min, i)}, m.hi[i] = double{component(s.origins.max, i)};
    m.lo_speed[i] = double{component(s.ends.min, i)} - m.lo[i];
    m.hi_speed[i] = double{component(s.ends.max, i)} - m.hi[i];
  }
  return m;
}

Moving moving(const Frustum& f) {
  Moving m{};
  for (int i = 0; i < 3; ++i) {
    m.lo[i] = double{component(f.origins.min, i)}, m.hi[i] = double{component(f.origins.max, i)};
    m.lo_speed[i] = double{f.reach} * double{component(f.directions.min, i)};
    m.hi_speed[i] = double{f.reach} * double{component(f.directions.max, i)};
  }
  return m;
}

double beyond_hull(const Shaft& /*shaft*/, const Box& /*box*/) {
  return -1;
}
double beyond_hull(const Frustum& f, const Box& box) {
  return -double{min_component(min(f.hull.max - box.min, box.max - f.hull.min))};
}

template <class Bound>
void expect_tight_beam(std::uint64_t seed) {
  Random random(seed);
  const Box scene{{-10, -10, -10}, {10, 10, 10}};
  int accepted = 0, rejected = 0;
  for (int i = 0; i < 50000; ++i) {
    Bound bound;
    bound_rays(loose_bundle(random), scene, &bound);
    const Vec3 p = random.in_box(8);
    const Box box = box_of_triangle(p, p + random.in_box(3), p + random.in_box(3));
    const double distance = std::max(least_distance(moving(bound), box), beyond_hull(bound, box));
    const bool hit = meets(make_node_test(bound), box);
    (hit ? accepted : rejected)++;
    if (distance <= 0) {
      ASSERT_TRUE(hit) << i;
    }
    // Rounding errors of t are multiplied by the speeds, which are at most about 20.
    if (hit) {
      ASSERT_LE(distance, 3e-4) << i;
    }
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(rejected, 5000);
}

TEST(Bounds, BeamsAreAsTightAsTheExactTest) {
  expect_tight_beam<Shaft>(81);
  expect_tight_beam<Frustum>(82);
}

/// The distance from a sphere's centre to a cone that is truncated at a reach, in the half plane of
/// the header's drawing.
double distance_to_cone(const FiniteCone& bound, Vec3 point) {
  const Vec3 x = bound.rays.directions.axis, c = bound.rays.origins.center;
  const double px = double{point.x} - c.x, py = double{point.y} - c.y, pz = double{point.z} - c.z;
  const double a = px * x.x + py * x.y + pz * x.z, vv = px * px + py * py + pz * pz;
  const double b = std::sqrt(std::max(0.0, vv - a * a));
  const double sine = bound.rays.directions.sin_angle, cosine = std::sqrt(1 - sine * sine);
  const double reach = bound.reach;
  if (std::atan2(b, a) <= std::asin(sine)) return std::max(0.0, std::sqrt(vv) - reach);
  const double e = std::clamp(a * cosine + b * sine, 0.0, reach);
  return std::hypot(a - e * cosine, b - e * sine);
}

TEST(Bounds, FiniteConesAreAsTightAsTheExactTest) {
  Random random(83);
  const Box scene{{-10, -10, -10}, {10, 10, 10}};
  int accepted = 0, rejected = 0, beyond = 0;
  for (int i = 0; i < 100000; ++i) {
    FiniteCone bound;
    bound_rays(loose_bundle(random), scene, &bound);
    if (bound.rays.directions.whole()) continue;
    const Vec3 center = random.in_box(10);
    const float radius = random.between(0, 2);
    const double distance = distance_to_cone(bound, center);
    const double sum = double{bound.rays.origins.radius} + radius;
    const bool hit = meets(make_node_test(bound), center, radius);
    (hit ? accepted : rejected)++;
    if (distance <= sum) {
      ASSERT_TRUE(hit) << i;
    }
    if (hit) {
      ASSERT_LE(distance, sum + 3e-4) << i;
    }
    if (!hit && meets(make_cone_sphere_test(bound.rays), center, radius)) ++beyond;
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(rejected, 10000);
  EXPECT_GT(beyond, 100);
}

}  // namespace
}  // namespace raysheaf
