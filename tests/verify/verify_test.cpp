// The checks pass for the library and detect every error.
#include "raysheaf/verify.h"

#include <gtest/gtest.h>

#include <limits>

#include <algorithm>

#include "lab/verify/families.h"
#include "lab/verify/point_judge.h"
#include "lab/verify/round.h"
#include "lab/verify/watertight.h"
#include "lab/verify/world.h"
#include "raysheaf/error.h"

namespace raysheaf::checks {
namespace {

VerifyReport checked(const Subject& subject, Promise promise, std::uint64_t rounds,
                     std::uint64_t seed = 1) {
  VerifyOptions options;
  options.promises = {promise};
  options.rounds = rounds;
  options.seed = seed;
  return verify_subject(subject, options);
}

TEST(Verify, EveryPromiseIsKept) {
  VerifyOptions options;
  options.rounds = 2;
  const VerifyReport report = raysheaf::verify(options);
  EXPECT_TRUE(report.kept());
  ASSERT_EQ(report.promises.size(), kPromises.size());
  for (std::size_t i = 0; i < kPromises.size(); ++i) {
    const PromiseReport& promise = report.promises[i];
    EXPECT_EQ(promise.promise, kPromises[i]);
    EXPECT_EQ(promise.rounds, 2u);
    EXPECT_GT(promise.cases, 100u);
    EXPECT_TRUE(promise.first_failures.empty());
  }
  for (const ErrorHistogram& errors : report.errors) EXPECT_GT(errors.total(), 50u) << errors.what;
}

TEST(Verify, TheSameSeedTriesTheSameCases) {
  const Subject subject(1);
  for (const Promise promise : kPromises) {
    const VerifyReport a = checked(subject, promise, 1, 5), b = checked(subject, promise, 1, 5);
    EXPECT_EQ(a.promises[0].cases, b.promises[0].cases) << to_string(promise);
    ASSERT_EQ(a.errors.size(), b.errors.size());
    for (std::size_t i = 0; i < a.errors.size(); ++i)
      EXPECT_EQ(a.errors[i].counts, b.errors[i].counts);
  }
}

/// Expects that the check fails. Its first failure must be reproducible from its seed and contain
/// these words.
void expect_found(const Subject& subject, Promise promise, std::uint64_t rounds,
                  const std::string& words) {
  const VerifyReport report = checked(subject, promise, rounds);
  EXPECT_FALSE(report.kept());
  const PromiseReport& found = report.promises[0];
  ASSERT_FALSE(found.first_failures.empty()) << to_string(promise);
  EXPECT_LE(found.first_failures.size(), 10u);
  EXPECT_GE(found.failures, found.first_failures.size());
  const VerifyFailure& first = found.first_failures.front();
  EXPECT_NE(first.what.find(words), std::string::npos) << first.what;
  const VerifyReport again = checked(subject, promise, 1, first.seed);
  ASSERT_FALSE(again.promises[0].first_failures.empty());
  EXPECT_EQ(again.promises[0].first_failures.front().what, first.what);
}

/// Whether the ray is one of those, by its origin, for which the test gives wrong answers.
bool is_unlucky(const Ray& ray) {
  return ray.origin.x > ray.origin.y;
}

TEST(Verify, AHitThatIsOffByABitIsFound) {
  Subject subject(1);
  subject.closest_hit = [](const Scene& scene, std::span<const Ray> rays,
                           const QueryOptions& options) {
    std::vector<Hit> hits = closest_hit(scene, rays, options);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (is_unlucky(rays[i]) && hits[i].v > 0) hits[i].v = std::nextafter(hits[i].v, 0.0f);
    return hits;
  };
  expect_found(subject, Promise::kBruteForce, 5, ", 1 thread, closest_hit");
}

TEST(Verify, AHitThatIsLostAmongAllIsFound) {
  Subject subject(1);
  subject.all_hits = [](const Scene& scene, std::span<const Ray> rays,
                        const QueryOptions& options) {
    HitRows rows = all_hits(scene, rays, options);
    if (rows.hits.empty()) return rows;
    rows.hits.pop_back();
    const std::uint64_t count = rows.hits.size();
    for (std::uint64_t& offset : rows.offsets) offset = std::min(offset, count);
    return rows;
  };
  expect_found(subject, Promise::kBruteForce, 5, "all_hits");
  expect_found(subject, Promise::kBounds, 20, "all_hits");
}

TEST(Verify, AnAnswerThatDependsOnTheBatchIsFound) {
  Subject subject(1);
  subject.any_hit = [](const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
    std::vector<std::uint8_t> any = any_hit(scene, rays, options);
    if (rays.size() == 2) any.back() ^= 1;
    return any;
  };
  expect_found(subject, Promise::kDeterminism, 10, "any_hit in pieces");
}

TEST(Verify, AGapIsFound) {
  Subject subject(1);
  // The edge u = 0 belongs to no triangle.
  subject.closest_hit = [](const Scene& scene, std::span<const Ray> rays,
                           const QueryOptions& options) {
    std::vector<Hit> hits = closest_hit(scene, rays, options);
    for (Hit& hit : hits)
      if (hit.u == 0 || hit.v == 0) hit = {};
    return hits;
  };
  expect_found(subject, Promise::kWatertight, 2, "closest_hit of dual");
}

TEST(Verify, ABoundThatLosesAHitIsFound) {
  Subject subject(1);
  subject.any_hit = [](const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
    std::vector<std::uint8_t> any = any_hit(scene, rays, options);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (is_unlucky(rays[i])) any[i] = 0;
    return any;
  };
  expect_found(subject, Promise::kBounds, 20, "any_hit of dual");
}

TEST(Verify, ATestWithoutTheLastBitsIsFound) {
  Subject subject(1);
  subject.intersect = [](const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c, TriangleHit* hit) {
    RaySetup line = ray;
    line.t_min = -std::numeric_limits<float>::infinity();
    line.t_max = -line.t_min;
    if (!intersect_triangle(line, a, b, c, hit)) return false;
    hit->t *= 1 + 0x1p-21f;
    return is_within(hit->t, ray.t_min, ray.t_max);
  };
  expect_found(subject, Promise::kExact, 2, "t is wrong by");
  // The edge u = 0 belongs to no triangle.
  subject.intersect = [](const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c, TriangleHit* hit) {
    return intersect_triangle(ray, a, b, c, hit) && hit->u > 0;
  };
  expect_found(subject, Promise::kExact, 2, "a missed hit");
  // The triangle is too large.
  subject.intersect = [](const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c, TriangleHit* hit) {
    if (line_meets_triangle(ray.origin, ray.direction, a, b, c, hit))
      return is_within(hit->t, ray.t_min, ray.t_max);
    return intersect_triangle(ray, a, b + (b - a) * 0x1p-20f, c, hit);
  };
  expect_found(subject, Promise::kExact, 2, "a false hit");
}

TEST(Verify, AQueryThatLosesAnEdgeIsFound) {
  Subject subject(1);
  subject.any_hit = [](const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
    const std::vector<Hit> hits = closest_hit(scene, rays, options);
    std::vector<std::uint8_t> any;
    for (const Hit& hit : hits) any.push_back(hit.prim_id != kInvalidId && hit.v > 0 ? 1 : 0);
    return any;
  };
  expect_found(subject, Promise::kExact, 2, "any_hit");
}

// --- every promise finds wrong answers of every kind that it speaks about ------------------------

/// Which answers of a batch are wrong: the same rays in other batches have correct ones.
constexpr std::size_t kWrongEvery = 7;

template <class Change>
void change_hits(Subject* subject, const Change& change) {
  subject->closest_hit = [change](const Scene& scene, std::span<const Ray> rays,
                                  const QueryOptions& options) {
    std::vector<Hit> hits = closest_hit(scene, rays, options);
    for (std::size_t i = 0; i < hits.size(); i += kWrongEvery)
      if (hits[i].prim_id != kInvalidId) change(&hits[i]);
    return hits;
  };
}

struct Mutant {
  const char* name;
  void (*make)(Subject*);
  std::vector<Promise> found_by;
};

const std::vector<Mutant>& mutants() {
  using enum Promise;
  static const std::vector<Mutant> all{
      {"t + 1 ulp",
       [](Subject* subject) {
         change_hits(subject, [](Hit* hit) { hit->t = std::nextafter(hit->t, 1e38f); });
       },
       {kBruteForce, kDeterminism, kExact, kHistory}},
      {"a triangle's id",
       [](Subject* subject) { change_hits(subject, [](Hit* hit) { hit->prim_id ^= 1; }); },
       {kBruteForce, kDeterminism, kExact, kHistory}},
      {"an instance's id",
       [](Subject* subject) { change_hits(subject, [](Hit* hit) { ++hit->inst_id; }); },
       {kBruteForce, kDeterminism, kExact, kHistory}},
      {"a lost closest hit",
       [](Subject* subject) { change_hits(subject, [](Hit* hit) { *hit = {}; }); },
       {kBruteForce, kDeterminism, kWatertight, kBounds, kExact, kInstances, kHistory}},
      {"a lost occlusion",
       [](Subject* subject) {
         subject->any_hit = [](const Scene& scene, std::span<const Ray> rays,
                               const QueryOptions& options) {
           std::vector<std::uint8_t> any = any_hit(scene, rays, options);
           for (std::size_t i = 0; i < any.size(); i += kWrongEvery) any[i] = 0;
           return any;
         };
       },
       {kBruteForce, kDeterminism, kWatertight, kBounds, kExact, kInstances, kHistory}},
      {"a lost hit among all",
       [](Subject* subject) {
         subject->all_hits = [](const Scene& scene, std::span<const Ray> rays,
                                const QueryOptions& options) {
           HitRows rows = all_hits(scene, rays, options);
           if (rows.hits.empty()) return rows;
           rows.hits.pop_back();
           for (std::uint64_t& offset : rows.offsets)
             offset = std::min<std::uint64_t>(offset, rows.hits.size());
           return rows;
         };
       },
       {kBruteForce, kDeterminism, kBounds, kExact, kHistory}},
      {"a lost hit among the first",
       [](Subject* subject) {
         subject->first_hits = [](const Scene& scene, std::span<const Ray> rays, std::uint32_t most,
                                  const QueryOptions& options) {
           return first_hits(scene, rays, most > 1 ? most - 1 : most, options);
         };
       },
       {kHistory}},
      {"a wrong count",
       [](Subject* subject) {
         subject->hit_counts = [](const Scene& scene, std::span<const Ray> rays,
                                  const QueryOptions& options) {
           std::vector<std::uint32_t> counts = hit_counts(scene, rays, options);
           for (std::uint32_t& count : counts) count = std::min(count, 3u);
           return counts;
         };
       },
       {kHistory}},
      {"the other side of a hit",
       [](Subject* subject) {
         subject->hit_points = [](const Scene& scene, std::span<const Ray> rays,
                                  std::span<const Hit> hits, std::span<const float> times) {
           std::vector<HitPoint> points = hit_points(scene, rays, hits, times);
           for (std::size_t i = 0; i < points.size(); i += kWrongEvery)
             points[i].front = !points[i].front;
           return points;
         };
       },
       {kInstances, kHistory}},
      {"the other side in the test",
       [](Subject* subject) {
         subject->intersect = [](const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c, TriangleHit* hit) {
           const bool met = intersect_triangle(ray, a, b, c, hit);
           if (met && hit->u < 0.125f) hit->front = !hit->front;
           return met;
         };
       },
       {kExact, kHistory}},
      {"t + 3 ulp in the test",
       [](Subject* subject) {
         subject->intersect = [](const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c, TriangleHit* hit) {
           const bool met = intersect_triangle(ray, a, b, c, hit);
           for (int i = 0; met && i < 3; ++i) hit->t = std::nextafter(hit->t, 1e38f);
           return met;
         };
       },
       {kExact, kHistory}},
      {"a distance + 1 ulp",
       [](Subject* subject) {
         subject->nearest = [](const Scene& scene, const PointParts& points, std::size_t k,
                               const PointOptions& options) {
           std::vector<ClosestPoint> found = nearest(scene, points, k, options);
           for (std::size_t i = 0; i < found.size(); i += kWrongEvery)
             found[i].distance = std::nextafter(found[i].distance, 1e300);
           return found;
         };
       },
       {kHistory}},
      {"the other side of a point",
       [](Subject* subject) {
         subject->nearest = [](const Scene& scene, const PointParts& points, std::size_t k,
                               const PointOptions& options) {
           std::vector<ClosestPoint> found = nearest(scene, points, k, options);
           for (ClosestPoint& one : found) one.side = -one.side;
           return found;
         };
       },
       {kHistory}},
      {"a wrong sign",
       [](Subject* subject) {
         subject->signed_distance = [](const Scene& scene, const PointParts& points,
                                       const PointOptions& options) {
           std::vector<double> distances = signed_distance(scene, points, options);
           for (std::size_t i = 0; i < distances.size(); i += kWrongEvery)
             distances[i] = -distances[i];
           return distances;
         };
       },
       {kHistory}},
      {"a wrong inside",
       [](Subject* subject) {
         subject->contains = [](const Scene& scene, const PointParts& points,
                                const PointOptions& options) {
           std::vector<std::uint8_t> inside = contains(scene, points, options);
           for (std::size_t i = 0; i < inside.size(); i += kWrongEvery) inside[i] ^= 1;
           return inside;
         };
       },
       {kHistory}},
      {"hits of other times",
       [](Subject* subject) {
         subject->closest_hit = [](const Scene& scene, std::span<const Ray> rays,
                                   QueryOptions options) {
           options.ray_times = {};
           return closest_hit(scene, rays, options);
         };
       },
       {kInstances, kHistory}},
      {"sides of other times",
       [](Subject* subject) {
         subject->hit_points = [](const Scene& scene, std::span<const Ray> rays,
                                  std::span<const Hit> hits,
                                  std::span<const float>) { return hit_points(scene, rays, hits); };
       },
       {kInstances}},
      {"hits of other worlds",
       [](Subject* subject) {
         subject->closest_hit = [](const Scene& scene, std::span<const Ray> rays,
                                   QueryOptions options) {
           options.ray_worlds = {};
           options.rays_per_world = 0;
           return closest_hit(scene, rays, options);
         };
       },
       {kInstances, kHistory}},
      {"points of other worlds",
       [](Subject* subject) {
         subject->nearest = [](const Scene& scene, const PointParts& points, std::size_t k,
                               PointOptions options) {
           options.point_worlds = {};
           return nearest(scene, points, k, options);
         };
       },
       {kHistory}},
  };
  return all;
}

TEST(Verify, EveryMutantIsFound) {
  for (const Mutant& mutant : mutants()) {
    Subject subject(1);
    mutant.make(&subject);
    for (const Promise promise : mutant.found_by) {
      bool found = false;
      for (std::uint64_t seed = 1; seed <= 5 && !found; ++seed)
        found = !checked(subject, promise, 1, seed).kept();
      EXPECT_TRUE(found) << mutant.name << ", " << to_string(promise);
    }
  }
}

TEST(Verify, WorldsAreAsTheirModel) {
  std::string changes;
  std::size_t triangles = 0, moved = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    World world(Subject(1).most().context, seed);
    for (int step = 0; step < 10; ++step) {
      EXPECT_EQ(world.change(), "");
      changes += world.last_changes() + ", ";
      const WorldView view = world.view();
      EXPECT_EQ(view.soup.meshes.size(), view.placed.size());
      EXPECT_EQ(view.soup.triangle_count(), world.scene().triangle_count());
      triangles += view.soup.triangle_count();
      for (const float time : {0.0f, 0.3f}) {
        const WorldView then = world.view(time);
        EXPECT_EQ(then.soup.triangle_count(), view.soup.triangle_count());
        for (std::size_t i = 0; i < then.placed.size(); ++i) {
          const Placed& placed = then.placed[i];
          EXPECT_EQ(world.scene().mesh_of(placed.instance), placed.mesh);
          EXPECT_EQ(world.scene().world(placed.instance), placed.world);
          EXPECT_EQ(placed.instance, view.placed[i].instance);
          moved += then.soup.meshes[i] == view.soup.meshes[i] ? 0 : 1;
        }
      }
      if (view.placed.empty()) continue;
      for (const RayFamily& family : ray_families()) {
        Random random(seed);
        for (const Ray& ray : family.make(view.soup, 40, &random))
          EXPECT_TRUE(is_legal(ray) && ray.t_min >= 0 && ray.t_min <= ray.t_max) << family.name;
      }
    }
  }
  for (const char* const change :
       {"add", "replace", "update", "remove,", "instance,", "instances", "remove_instance",
        "set_transform,", "set_transforms", "set_mask", "set_world", "copy", "refused"})
    EXPECT_NE(changes.find(change), std::string::npos) << change;
  EXPECT_GT(triangles, 20'000u);
  EXPECT_GT(moved, 20u);
}

/// A closed box: by six exact rays, and not where one of them meets an edge.
TEST(Verify, PointsAreJudgedByOtherArithmetic) {
  Soup soup;
  soup.meshes = {{{0, 0, 0},
                  {4, 0, 0},
                  {0, 4, 0},
                  {0, 0, 0},
                  {0, 4, 0},
                  {0, 0, 4},
                  {0, 0, 0},
                  {0, 0, 4},
                  {4, 0, 0},
                  {4, 0, 0},
                  {0, 0, 4},
                  {0, 4, 0}}};
  const std::vector<std::uint8_t> seen{1}, unseen{0};
  const auto inside = [&](Vec3 p) { return inside_exactly(p, soup, seen, InsideRule::kNonZero); };
  EXPECT_EQ(inside({0.5f, 0.25f, 0.75f}), std::optional(true));
  EXPECT_EQ(inside({3, 2, 1.5f}), std::optional(false));
  EXPECT_EQ(inside({2, 2, 1}), std::nullopt);  // at the side of an edge
  EXPECT_EQ(inside_exactly({0.5f, 0.25f, 0.75f}, soup, unseen, InsideRule::kEvenOdd),
            std::optional(false));

  ClosestPoint found;
  found.geom_id = 0, found.prim_id = 1, found.distance = 2, found.side = -1;
  EXPECT_EQ(fault_of({-2, 1, 1}, found, soup, seen), "");
  found.side = 1;
  EXPECT_NE(fault_of({-2, 1, 1}, found, soup, seen).find("side"), std::string::npos);
  found.side = -1, found.distance = 2 - 0x1p-44;
  EXPECT_NE(fault_of({-2, 1, 1}, found, soup, seen).find("the distance"), std::string::npos);
  found.distance = 2 + 0x1p-44;
  EXPECT_NE(fault_of({-2, 1, 1}, found, soup, seen).find("nearer"), std::string::npos);
}

TEST(Verify, SecondsLimitRounds) {
  VerifyOptions options;
  options.promises = {Promise::kHistory};
  options.seconds = 1e-3;
  std::uint64_t most = 0;
  options.progress = [&](const Progress& progress) {
    EXPECT_LE(progress.done, progress.total);
    most = progress.total;
    return true;
  };
  const VerifyReport report = raysheaf::verify(options);
  EXPECT_TRUE(report.kept());
  EXPECT_EQ(report.promises[0].rounds, 1u);
  EXPECT_EQ(most, 1u);
  options.seconds = 600;  // more than one round, however busy the machine is
  options.progress = [](const Progress& progress) { return progress.done < 2; };
  EXPECT_THROW((void)raysheaf::verify(options), Error);
  options.progress = nullptr;
  options.seconds = -1;
  EXPECT_THROW((void)raysheaf::verify(options), Error);
}

TEST(Verify, RaysAreCountedWhereAsked) {
  VerifyOptions options;
  options.promises = {Promise::kWatertight};
  options.edge_rays = 300000;
  const VerifyReport report = raysheaf::verify(options);
  EXPECT_TRUE(report.kept());
  EXPECT_GE(report.promises[0].cases, 300000u);
  EXPECT_EQ(report.promises[0].rounds, 2u);
  options.promises = {Promise::kExact};
  options.exact_rays = 6000;
  const VerifyReport exact = raysheaf::verify(options);
  EXPECT_GE(exact.promises[0].cases, 6000u);
  EXPECT_EQ(exact.promises[0].rounds, 2u);
}

TEST(Verify, ProgressMayStop) {
  VerifyOptions options;
  std::vector<std::string> stages;
  options.rounds = 2;
  options.progress = [&](const Progress& progress) {
    stages.emplace_back(progress.stage);
    EXPECT_LE(progress.done, progress.total);
    return stages.size() < 5;
  };
  try {
    (void)raysheaf::verify(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCancelled);
  }
  EXPECT_EQ(stages.front(), "brute-force");
  EXPECT_EQ(stages.back(), "determinism");
}

TEST(Verify, NamesOfPromises) {
  for (const Promise promise : kPromises)
    EXPECT_EQ(promise_from_string(to_string(promise)), promise);
  EXPECT_THROW((void)promise_from_string("speed"), Error);
  VerifyOptions options;
  options.threads = 1025;
  EXPECT_THROW((void)raysheaf::verify(options), Error);
}

TEST(Verify, HistogramsHoldWhatTheirLimitsSay) {
  ErrorHistogram histogram;
  for (const double error : {0.0, 0.5, 0.51, 1.0, 1.5, 2.0, 1e30}) histogram.add(error);
  EXPECT_EQ(histogram.counts[0], 2u);
  EXPECT_EQ(histogram.counts[1], 2u);
  EXPECT_EQ(histogram.counts[2], 2u);
  EXPECT_EQ(histogram.counts.back(), 1u);
  EXPECT_EQ(histogram.largest, 1e30);
  EXPECT_EQ(histogram.total(), 7u);
}

/// In a closed mesh of any kind, every edge has a triangle on either side.
TEST(Verify, MeshesAreClosed) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const ClosedMesh mesh = make_closed_mesh(seed);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
    std::sort(edges.begin(), edges.end());
    ASSERT_EQ(edges.size() % 2, 0u) << mesh.kind;
    for (std::size_t i = 0; i < edges.size(); i += 2) {
      ASSERT_EQ(edges[i], edges[i + 1]) << mesh.kind;
      ASSERT_TRUE(i + 2 == edges.size() || edges[i + 1] != edges[i + 2]) << mesh.kind;
    }
  }
}

}  // namespace
}  // namespace raysheaf::checks
