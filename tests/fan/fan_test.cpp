#include <gtest/gtest.h>

#include <numeric>

#include "fan/fan_support.h"
#include "support/simd_targets.h"

namespace raysheaf {
namespace {

using test::Random;
using test::Triangles;

enum class Shape { kSoup, kLarge, kSlivers, kAround, kAtOrigin, kZeroArea, kLattice };
const Shape kShapes[] = {Shape::kSoup,     Shape::kLarge,    Shape::kSlivers, Shape::kAround,
                         Shape::kAtOrigin, Shape::kZeroArea, Shape::kLattice};

/// With small integers as coordinates, rays hit edges and corners exactly.
Vec3 lattice_point(Random& random) {
  const auto c = [&] { return static_cast<float>(random.below(9)) - 4.0f; };
  return {c(), c(), c()};
}

void add_triangle(Shape shape, Vec3 o, Random& random, Triangles* t) {
  const Vec3 p = o + random.in_box(10);
  switch (shape) {
    case Shape::kSoup:
      return t->add(p, p + random.in_box(1.5f), p + random.in_box(1.5f));
    case Shape::kLarge:
      return t->add(o + random.in_box(20), o + random.in_box(20), o + random.in_box(20));
    case Shape::kSlivers: {
      const Vec3 along = random.in_box(9);
      return t->add(p, p + along, p + along * 0.5f + random.in_box(1e-5f));
    }
    case Shape::kAround: {
      const Vec3 q = random.in_box(0.1f);
      return t->add(o + q, o + q + random.in_box(3), o + random.in_box(0.01f));
    }
    case Shape::kAtOrigin: {
      const Vec3 a = random.in_box(3), b = random.in_box(3);
      if (random.below(3) == 0) return t->add(o, o + a, o + b);
      if (random.below(2) == 0) return t->add(o + a, o - a, o + b);
      return t->add(o + a, o + b, o - (a + b));
    }
    case Shape::kZeroArea: {
      const Vec3 along = random.in_box(4);
      if (random.below(2) == 0) return t->add(p, p + along, p + along);
      return t->add(o + Vec3{1, 2, 3}, o + Vec3{3, 6, 9}, o + Vec3{2, 4, 6});
    }
    case Shape::kLattice:
      return t->add(o + lattice_point(random), o + lattice_point(random),
                    o + lattice_point(random));
  }
}

/// Targets on corners, on edges and anywhere; axes, diagonals, repetitions; all intervals of t.
std::vector<Ray> rays_at(const Triangles& t, Vec3 o, std::uint32_t count, Random& random) {
  std::vector<Ray> rays;
  const Vec3 special[] = {{1, 0, 0},  {0, -1, 0}, {0, 0, 1},   {1, 1, 0},  {-1, 0, 1},
                          {0, 1, -1}, {1, 1, 1},  {-1, 1, -1}, {1, -1, 1}, {2, 1, 2},
                          {-1, 0, 0}, {0, 1, 0},  {0, 0, -1},  {1, 2, -2}, {-3, 3, 1}};
  while (rays.size() < count) {
    Vec3 d = random.direction();
    const std::uint32_t aim = random.below(8);
    if (aim < 4 && t.count() > 0) {
      const auto [a, b, c] = t.corners(random.below(t.count()));
      d = aim == 0 ? a - o : aim == 1 ? (a + b) * 0.5f - o : (a + b + c) * (1 / 3.0f) - o;
    } else if (aim == 4) {
      d = special[random.below(15)];
    } else if (aim == 5 && !rays.empty()) {
      d = rays.back().direction;
    } else if (aim == 6) {
      d = lattice_point(random);
    }
    Ray ray{o, 0, d, 1};
    const std::uint32_t range = random.below(8);
    if (range == 0) ray.t_max = std::numeric_limits<float>::infinity();
    if (range == 1) ray.t_min = 0.9f, ray.t_max = 1.1f;
    if (range == 2) ray.t_max = 0.999f;
    if (range == 3) ray.t_min = 1.0f;
    if (range == 4) ray.t_max = 3;
    rays.push_back(ray);
  }
  return rays;
}

void expect_brute_force(Triangles& t, const std::vector<Ray>& rays, const std::string& what) {
  const Executor one(1), two(2);
  for (const Facing facing : {Facing::kBoth, Facing::kSkipBackOfSingleSided}) {
    if (facing != Facing::kBoth && t.flags.empty()) continue;
    const std::vector<std::uint8_t> expected = test::brute_force(t, rays, facing);
    FanCounts counts;
    const TriangleSource source = t.source();
    test::for_each_simd_target([&](const char* target) {
      for (const Executor* executor : {&one, &two}) {
        FanCounts now;
        const auto got = test::fan(*executor, source, rays, {facing}, &now);
        for (std::size_t i = 0; i < rays.size(); ++i)
          ASSERT_EQ(got[i], expected[i]) << what << ", " << target << ", ray " << i;
        if (counts.bound_tests == 0) counts = now;
        EXPECT_EQ(now.bound_tests, counts.bound_tests) << what << ", " << target;
        EXPECT_EQ(now.triangle_tests, counts.triangle_tests) << what << ", " << target;
      }
    });
  }
}

Triangles make(Shape shape, Vec3 o, std::uint32_t count, Random& random) {
  Triangles t;
  for (std::uint32_t i = 0; i < count; ++i) add_triangle(shape, o, random, &t);
  for (std::uint32_t i = 0; i < count; ++i)
    t.flags.push_back(static_cast<std::uint8_t>(random.below(4)));
  return t;
}

TEST(Fan, EqualsBruteForce) {
  Random random(3);
  for (const Shape shape : kShapes) {
    for (const Vec3 o : {Vec3{0, 0, 0}, Vec3{3, -2, 7}, Vec3{0.1f, 0.7f, -0.3f}}) {
      Triangles t = make(shape, o, 300, random);
      expect_brute_force(t, rays_at(t, o, 700, random),
                         "shape " + std::to_string(static_cast<int>(shape)));
    }
  }
}

TEST(Fan, AnyScale) {
  Random random(5);
  for (const float scale : {1e-15f, 1e-9f, 1e-4f, 1e5f, 1e12f, 1e15f}) {
    for (const Shape shape : {Shape::kSoup, Shape::kLarge, Shape::kAround, Shape::kLattice}) {
      Triangles t = make(shape, {}, 150, random);
      std::vector<Ray> rays = rays_at(t, {}, 400, random);
      for (Vec3& p : t.positions) p = p * scale;
      for (Ray& ray : rays) ray.direction = ray.direction * scale;
      expect_brute_force(t, rays, "scale " + std::to_string(scale));
      for (Ray& ray : rays) {
        ray.direction = ray.direction * (1 / scale);
        ray.t_min *= scale, ray.t_max *= scale;
      }
      expect_brute_force(t, rays, "scaled t " + std::to_string(scale));
    }
  }
}

TEST(Fan, RangesBehindTheOriginAndDeadRays) {
  Random random(7);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Shape shape : kShapes) {
    Triangles t = make(shape, {1, 1, 1}, 200, random);
    std::vector<Ray> rays = rays_at(t, {1, 1, 1}, 400, random);
    for (Ray& ray : rays) {
      const std::uint32_t kind = random.below(10);
      if (kind == 0) ray.t_min = -2, ray.t_max = -0.5f;
      if (kind == 1) ray.t_min = -kInfinity, ray.t_max = kInfinity;
      if (kind == 2) ray.direction = {0, 0, 0};
      if (kind == 3) ray.t_min = 2, ray.t_max = 1;
      if (kind == 4) ray.direction.y = nan;
      if (kind == 5) ray.t_max = nan;
      if (kind == 6) ray.direction = ray.direction * 1e-39f, ray.t_max = kInfinity;
      if (kind == 7) ray.direction.x = kInfinity;
    }
    expect_brute_force(t, rays, "shape " + std::to_string(static_cast<int>(shape)));
  }
}

TEST(Fan, FewRaysAndFewTriangles) {
  Random random(11);
  for (const std::uint32_t triangles : {0u, 1u, 2u, 17u}) {
    for (const std::uint32_t rays : {0u, 1u, 2u, 15u, 16u, 17u, 257u}) {
      Triangles t = make(Shape::kLarge, {}, triangles, random);
      expect_brute_force(t, rays_at(t, {}, rays, random), "few");
    }
  }
}

// A single ray is the border of its face's rectangle.
TEST(Fan, OneRayAtACornerOrAnEdge) {
  Random random(12);
  for (const Vec3 o : {Vec3{0, 0, 0}, Vec3{0.1f, 0.7f, -0.3f}}) {
    for (int i = 0; i < 3000; ++i) {
      Triangles t = make(Shape::kLarge, o, 1, random);
      const auto [a, b, c] = t.corners(0);
      const Vec3 aim = random.below(2) == 0 ? a : (b + c) * 0.5f;
      expect_brute_force(t, {Ray{o, 0, aim - o, 3}}, "aimed");
    }
  }
}

TEST(Fan, ManyRaysInOneCellAndOnOneDirection) {
  Random random(13);
  Triangles t = make(Shape::kLarge, {}, 200, random);
  for (const float spread : {0.0f, 1e-6f, 1e-3f}) {
    std::vector<Ray> rays;
    for (int i = 0; i < 3000; ++i)
      rays.push_back(
          {{}, 0, Vec3{0.3f, 0.5f, -0.9f} + random.in_box(spread), random.between(0, 9)});
    expect_brute_force(t, rays, "spread");
  }
}

// Many rays from inside through corners and edges of a closed mesh.
TEST(Fan, ClosedMeshLetsNothingThrough) {
  Random random(17);
  Triangles t;
  constexpr int kRings = 24, kSectors = 48;
  const auto point = [](int i, int k) {
    const float a = static_cast<float>(i) * 3.14159265f / kRings;
    const float b = static_cast<float>(k % kSectors) * 6.2831853f / kSectors;
    const bool pole = i == 0 || i == kRings;
    return pole ? Vec3{0, i == 0 ? 2.0f : -2.0f, 0}
                : Vec3{3 * std::sin(a) * std::cos(b), 2 * std::cos(a),
                       5 * std::sin(a) * std::sin(b)};
  };
  for (int i = 0; i < kRings; ++i) {
    for (int k = 0; k < kSectors; ++k) {
      t.add(point(i, k), point(i + 1, k), point(i + 1, k + 1));
      t.add(point(i, k), point(i + 1, k + 1), point(i, k + 1));
    }
  }
  const Vec3 o{0.3f, -0.2f, 0.7f};
  std::vector<Ray> rays = rays_at(t, o, 30000, random);
  for (Ray& ray : rays) {
    ray.t_min = 0, ray.t_max = std::numeric_limits<float>::infinity();
    if (length(ray.direction) == 0) ray.direction = {1, 0, 0};
  }
  const Executor executor(2);
  const auto got = test::fan(executor, t.source(), rays);
  EXPECT_EQ(std::accumulate(got.begin(), got.end(), std::size_t{0}), rays.size());
  // Intervals that end near the mesh, where depths decide. Only some of the rays: 30 000 times 2
  // 304 pairs are too many for brute force.
  std::vector<Ray> near(rays.begin(), rays.begin() + 3000);
  for (Ray& ray : near) ray.t_max = random.between(0.2f, 1.3f);
  EXPECT_EQ(test::fan(executor, t.source(), near), test::brute_force(t, near, Facing::kBoth));
}

TEST(Fan, SharesOfTestsSumToTheCounts) {
  Random random(19);
  Triangles t = make(Shape::kSoup, {}, 2000, random);
  std::vector<Ray> rays = rays_at(t, {}, 4096, random);
  std::vector<float> tests;
  FanCounts counts;
  test::fan(Executor(2), t.source(), rays, {}, &counts, &tests);
  const double sum = std::accumulate(tests.begin(), tests.end(), 0.0);
  const auto total = static_cast<double>(counts.bound_tests + counts.triangle_tests);
  EXPECT_NEAR(sum, total, total * 1e-3);
}

TEST(Fan, MemoryIsKeptAndChangesNothing) {
  Random random(23);
  FanMemory memory;
  FanOptions options;
  options.memory = &memory;
  for (const std::uint32_t count : {3000u, 10u, 5000u, 1u}) {
    Triangles t = make(Shape::kSoup, {}, 100, random);
    const std::vector<Ray> rays = rays_at(t, {}, count, random);
    EXPECT_EQ(test::fan(Executor(2), t.source(), rays, options),
              test::brute_force(t, rays, Facing::kBoth));
  }
  EXPECT_GT(memory.bytes(), 0u);
}

TEST(Fan, GivesUpWhereTrianglesMeetTooManyTiles) {
  Random random(31);
  Triangles t;
  for (int i = 0; i < 20000; ++i) {
    const float z = 1 + random.unit();
    t.add({-9, -9, z}, {9, -9, z}, {0, 9, z});
  }
  std::vector<Ray> rays;
  for (int i = 0; i < 100000; ++i)
    rays.push_back(
        {{0, 0, 0}, 0, normalized({random.between(-1, 1), random.between(-1, 1), 1}), 9});
  FanMemory memory;
  FanOptions options;
  options.memory = &memory;
  options.most_pairs = 50000;
  std::vector<std::uint8_t> occluded(rays.size());
  std::uint64_t pairs = 0;
  for (const unsigned threads : {1u, 3u}) {
    FanCounts counts;
    const Executor executor(threads);
    EXPECT_FALSE(occluded_in_fan(executor, t.source(), rays, options, occluded, {}, &counts));
    EXPECT_GT(counts.pairs, options.most_pairs);
    EXPECT_LT(counts.pairs, 4 * options.most_pairs + 20 * 1000);  // one triangle's tiles per block
    EXPECT_EQ(threads == 1 ? counts.pairs : pairs, counts.pairs);
    pairs = counts.pairs;
  }
  EXPECT_LT(memory.bytes(), 100u << 20);
}

TEST(Fan, RefusesOtherOrigins) {
  Random random(10);
  Triangles t = make(Shape::kSoup, {}, 100, random);
  std::vector<std::uint8_t> occluded(20000, 7);
  for (const std::size_t other : {1u, 777u, 8191u, 19998u, 19999u}) {
    std::vector<Ray> rays(20000, Ray{{1, 2, 0}, 0, {1, 0, 0}, 1});
    rays[other].origin.z = -0.0f;  // differs in its bits
    FanCounts counts;
    EXPECT_FALSE(
        occluded_in_fan(Executor(2), t.source(), View<const Ray>(rays), {}, occluded, {}, &counts));
    EXPECT_EQ(counts.pairs, 0u);
  }
  EXPECT_EQ(std::count(occluded.begin(), occluded.end(), 7), 20000);
}

}  // namespace
}  // namespace raysheaf
