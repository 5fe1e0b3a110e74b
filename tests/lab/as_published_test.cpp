// Compares the counts in the published program's mode with a simple implementation of the paper,
// and with the paper's figures.
#include "lab/as_published.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "paper/base/flat_arrays.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/published.h"
#include "tests/support/scenes.h"

namespace raysheaf {
namespace {

using ConeTest = Quirks::ConeTest;

// ----- Equations 1 to 9 in double precision, one node and one triangle at a time.

struct NaivePoint {
  double x = 0, y = 0, z = 0;
};
NaivePoint point(Vec3 v) {
  return {v.x, v.y, v.z};
}
NaivePoint sum(NaivePoint a, NaivePoint b, double s = 1) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double product(NaivePoint a, NaivePoint b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
double size(NaivePoint a) {
  return std::sqrt(product(a, a));
}
NaivePoint unit(NaivePoint a) {
  return sum({}, a, 1 / size(a));
}

struct NaiveNode {
  NaivePoint center, axis;
  double radius = 0, spread = 0;
};

NaiveNode naive_leaf(View<const Ray> rays, std::size_t first, std::size_t end) {
  NaiveNode n{point(rays[first].origin), unit(point(rays[first].direction)), 0, 0};
  for (std::size_t i = first + 1; i < end; ++i) {
    const double between = size(sum(point(rays[i].origin), n.center, -1));
    if (between > n.radius) {
      n.center = sum({}, sum(n.center, point(rays[i].origin)), 0.5);
      n.radius = between / 2 + n.radius;
    }
    const NaivePoint r = unit(point(rays[i].direction));
    const double c = product(n.axis, r);
    if (c >= std::cos(n.spread)) continue;
    const NaivePoint q = unit(sum(sum({}, n.axis, c), r, -1));
    n.axis = unit(sum(sum(sum({}, n.axis, std::cos(n.spread)), q, std::sin(n.spread)), r));
    n.spread = std::acos(std::min(1.0, product(n.axis, r)));
  }
  return n;
}

NaiveNode naive_parent(const std::vector<NaiveNode>& leaves, std::size_t first, std::size_t end) {
  NaiveNode n = leaves[first];
  for (std::size_t i = first + 1; i < end; ++i) {
    const NaiveNode& l = leaves[i];
    const double between = size(sum(l.center, n.center, -1));
    if (between + n.radius <= l.radius) {
      n.center = l.center, n.radius = l.radius;
    } else if (between + l.radius > n.radius) {
      n.center = sum({}, sum(n.center, l.center), 0.5);
      n.radius = between / 2 + std::max(n.radius, l.radius);
    }
    n.spread = std::acos(std::min(1.0, product(n.axis, l.axis))) / 2 + std::max(n.spread, l.spread);
    n.spread = std::min(n.spread, std::numbers::pi / 2);
    n.axis = unit(sum(n.axis, l.axis));
  }
  return n;
}

bool naive_meets(const NaiveNode& n, NaivePoint p, double d, bool has_sign) {
  if (n.spread >= std::numbers::pi / 2) return true;
  const NaivePoint v = sum(p, n.center, -1);
  const double a = product(v, n.axis), b = size(sum(v, n.axis, -a));
  return (has_sign ? a : std::fabs(a)) * std::tan(n.spread) + (d + n.radius) / std::cos(n.spread) >=
         b;
}

struct NaiveCounts {
  std::uint64_t top_tests = 0, top_hits = 0, leaf_hits = 0;
};

NaiveCounts naive_rah(const FlatScene& scene, View<const Ray> rays, bool has_sign) {
  std::vector<NaiveNode> leaves, tops;
  for (std::size_t i = 0; i < rays.size; i += 8)
    leaves.push_back(naive_leaf(rays, i, std::min(i + 8, rays.size)));
  for (std::size_t i = 0; i < leaves.size(); i += 8)
    tops.push_back(naive_parent(leaves, i, std::min(i + 8, leaves.size())));
  NaiveCounts counts;
  const FlatArrays arrays(Executor(1), scene);
  const TriangleView triangles = arrays.view();
  for (std::size_t n = 0; n < tops.size(); ++n) {
    for (std::uint32_t t = 0; t < scene.triangle_count; ++t) {
      const auto& sphere = triangles.sphere;
      const NaivePoint p{sphere[0][t], sphere[1][t], sphere[2][t]};
      const double d = sphere[3][t];
      ++counts.top_tests;
      if (!naive_meets(tops[n], p, d, has_sign)) continue;
      ++counts.top_hits;
      for (std::size_t c = 8 * n; c < std::min(8 * n + 8, leaves.size()); ++c)
        counts.leaf_hits += naive_meets(leaves[c], p, d, has_sign) ? 1 : 0;
    }
  }
  return counts;
}

/// Rays that fan out from a few places. They have no pixel order, so that rows stay as they are.
RayBatch fan(std::size_t count) {
  RayBatch batch;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<float>(i);
    const Vec3 origin{0.3f * std::sin(t * 0.01f), 1.0f + 0.001f * t, 0.2f * std::cos(t * 0.02f)};
    batch.rays.push_back(
        {origin, 0, {std::cos(t * 0.05f), -0.5f + 0.3f * std::sin(t * 0.03f), 0.7f}, 1});
    batch.keys.push_back(0);
    batch.lights.push_back(0);
    batch.slots.push_back(static_cast<std::uint32_t>(i));
    batch.pixels.push_back(static_cast<std::uint32_t>(i));
  }
  return batch;
}

class AsPublished : public testing::Test {
 protected:
  const SceneDescription description_ = builtin_scene("cornell");
  const Executor executor_{2};
  const FlatScene scene_ = flatten(executor_, description_, mesh_bounds(executor_, description_));

  BatchStatistics count(const RayBatch& batch, Method method, const Quirks& quirks) const {
    return count_as_published(executor_, scene_, batch, method, quirks, 1u << 20);
  }
};

void expect_close(std::uint64_t ours, std::uint64_t naive) {
  EXPECT_NEAR(static_cast<double>(ours), static_cast<double>(naive),
              1e-3 * static_cast<double>(naive));
}

TEST_F(AsPublished, RahIsTheNaiveReadingOfTheEquations) {
  const RayBatch batch = fan(2003);
  for (const bool has_sign : {true, false}) {
    Quirks quirks;
    quirks.cone_test = has_sign ? ConeTest::kSigned : ConeTest::kUnsigned;
    const BatchStatistics s = count(batch, Method::kRah, quirks);
    const NaiveCounts naive = naive_rah(scene_, batch.rays, has_sign);
    EXPECT_EQ(s.levels[0].tests, naive.top_tests);
    expect_close(s.levels[0].hits, naive.top_hits);
    expect_close(s.levels[1].hits, naive.leaf_hits);
    EXPECT_EQ(s.levels[1].tests, 8 * s.levels[0].hits);
    EXPECT_EQ(s.final_tests, 8 * s.levels[1].hits);
  }
}

TEST_F(AsPublished, WiderTestsAndLargerSpheresMeetMore) {
  const RayBatch batch = fan(1500);
  const auto top_hits = [&](ConeTest test, bool undersized) {
    Quirks quirks;
    quirks.cone_test = test;
    quirks.undersized_triangle_spheres = undersized;
    return count(batch, Method::kRah, quirks).levels[0].hits;
  };
  EXPECT_LE(top_hits(ConeTest::kExact, false), top_hits(ConeTest::kSigned, false));
  EXPECT_LT(top_hits(ConeTest::kSigned, false), top_hits(ConeTest::kUnsigned, false));
  EXPECT_LT(top_hits(ConeTest::kSigned, true), top_hits(ConeTest::kSigned, false));
}

TEST_F(AsPublished, PaddingIsWhatTheLastNodeLacks) {
  Quirks exact;
  exact.padded_counting = false;
  EXPECT_EQ(count(fan(64 * 5), Method::kRah, {}).total_tests(),
            count(fan(64 * 5), Method::kRah, exact).total_tests());
  const BatchStatistics padded = count(fan(64 * 5 + 1), Method::kRah, {});
  const BatchStatistics bare = count(fan(64 * 5 + 1), Method::kRah, exact);
  EXPECT_LT(bare.total_tests(), padded.total_tests());
  EXPECT_EQ(bare.levels[1].hits, padded.levels[1].hits);
  EXPECT_EQ(bare.levels[0].tests, padded.levels[0].tests);
}

TEST_F(AsPublished, ThePublishedAzimuthDependsOnlyOnASign) {
  RayBatch batch = fan(4000);
  const std::uint64_t coded = count(batch, Method::kCrsh, {}).chunks;
  Quirks corrected;
  corrected.azimuth_as_coded = false;
  EXPECT_LT(coded, count(batch, Method::kCrsh, corrected).chunks);
}

TEST_F(AsPublished, NoRaysMakeNoTests) {
  for (const Method method : {Method::kRah, Method::kCrsh})
    EXPECT_EQ(count(fan(0), method, {}).total_tests(), 0u);
  Quirks all_dropped;
  all_dropped.dropped_rays = 100;
  EXPECT_EQ(count(fan(10), Method::kRah, all_dropped).total_tests(), 0u);
}

TEST_F(AsPublished, DoesNotDependOnThreads) {
  const RayBatch batch = fan(3000);
  const Executor one(1);
  for (const Method method : {Method::kRah, Method::kCrsh}) {
    for (const std::uint32_t branching : {8u, 2000u}) {
      const auto count_on = [&](const Executor& executor) {
        return count_as_published(executor, scene_, batch, method, {}, 1u << 20, {2, branching})
            .total_tests();
      };
      EXPECT_EQ(count_on(one), count_on(executor_)) << branching;
    }
  }
}

TEST(Published, TablesAreConsistent) {
  for (const PublishedTable& t : published_tables()) {
    if (t.method == Method::kBrute) {
      EXPECT_EQ(t.total, t.brute_force_tests());
      continue;
    }
    const PublishedTable* brute = published_table(t.scene, Method::kBrute, t.kind);
    ASSERT_NE(brute, nullptr);
    EXPECT_EQ(t.rays, brute->rays);
    if (t.levels.size() < 2) continue;
    const PublishedLevel &top = t.levels[0], &leaf = t.levels[1];
    EXPECT_EQ(*leaf.tests.value, 8 * *top.hits.value);
    const auto total =
        static_cast<double>(*top.tests.value + *leaf.tests.value + 8 * *leaf.hits.value);
    const double slack = leaf.hits.rounded ? 5e-3 : 0;
    EXPECT_NEAR(total, static_cast<double>(t.total), slack * static_cast<double>(t.total));
  }
}

TEST(Published, TheSweepIsConsistentAndHoldsTheTables) {
  for (const PublishedTable& t : published_sweep()) {
    ASSERT_EQ(t.levels.size(), t.depth);
    for (std::size_t l = 1; l < t.levels.size(); ++l)
      EXPECT_EQ(*t.levels[l].tests.value, t.branching * *t.levels[l - 1].hits.value);
    if (t.depth == 2 && t.branching == 8) {
      EXPECT_EQ(t.total, published_table("cornell", t.method, RayKind::kShadow)->total);
    }
  }
}

TEST(Published, PercentagesAreThePapers) {
  const auto percent = [](std::string_view scene, Method method) {
    double total = 0, brute = 0;
    for (const RayKind kind : {RayKind::kShadow, RayKind::kReflection}) {
      const PublishedTable* t = published_table(scene, method, kind);
      if (t == nullptr) continue;
      total += static_cast<double>(t->total);
      brute += static_cast<double>(t->brute_force_tests());
    }
    return std::round(total / brute * 1e4) / 1e2;
  };
  EXPECT_EQ(percent("office", Method::kRah), 5.14);
  EXPECT_EQ(percent("office", Method::kCrsh), 1.86);
  EXPECT_EQ(percent("cornell", Method::kRah), 12.01);
  EXPECT_EQ(percent("cornell", Method::kCrsh), 8.83);
  EXPECT_EQ(percent("sponza", Method::kRah), 3.71);
  EXPECT_EQ(percent("sponza", Method::kCrsh), 2.38);
}

class PaperScene : public testing::TestWithParam<const char*> {};

TEST_P(PaperScene, IsCountedAsPublished) {
  const std::string name = GetParam();
  RAYSHEAF_SCENE_OR_SKIP(path, "paper/" + name + ".glb");
  Laboratory laboratory(load_scene(path), 512, 512);
  for (const Method method : {Method::kRah, Method::kCrsh}) {
    for (const RayKind kind : {RayKind::kShadow, RayKind::kReflection}) {
      const PublishedTable* table = published_table(name, method, kind);
      if (table == nullptr) continue;
      double total = 0, ours = 0, brute = 0;
      for (const LabRays rays : {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2}) {
        if ((rays == LabRays::kShadow) != (kind == RayKind::kShadow)) continue;
        const auto published = laboratory.measure_as_published(rays, method, {});
        total += static_cast<double>(published.total_tests());
        const auto right = laboratory.measure(rays, method_settings(method), false);
        ours += static_cast<double>(right.total_tests());
        brute += static_cast<double>(right.brute_force_tests());
        const std::uint64_t nodes = (right.rays + 63) / 64;
        if (method == Method::kRah) {
          EXPECT_EQ(right.levels[0].tests, nodes * right.triangles);
        }
      }
      EXPECT_NEAR(total / static_cast<double>(table->total), 1, 0.04) << to_string(method);
      EXPECT_LE(ours / brute, table->relative());
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Scenes, PaperScene, testing::Values("office", "cornell", "sponza"));

}  // namespace
}  // namespace raysheaf
