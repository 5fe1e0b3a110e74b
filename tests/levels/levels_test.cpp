// Rays through two levels have the hits of the flat scene, bit for bit, and the bounds by which
// triangles are left out hold.
#include <cmath>

#include "levels/instances.h"
#include "levels/trace_levels.h"
#include "methods/dual/far_ray.h"
#include "scene/motion.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

double largest_error(const Affine& map, Vec3 p, int row) {
  const auto exact = static_cast<long double>(map.m[row][0]) * p.x +
                     static_cast<long double>(map.m[row][1]) * p.y +
                     static_cast<long double>(map.m[row][2]) * p.z + map.m[row][3];
  return static_cast<double>(std::fabs(component(transform_point(map, p), row) - exact));
}

TEST(Placing, BoundsWhatPlacingRounds) {
  Random random(1);
  double worst = 0;
  for (int n = 0; n < 3000; ++n) {
    const Affine map = random_map(kKinds[random.below(9)], 100, random);
    const Vec3 p = random.in_box(5);
    for (int row = 0; row < 3; ++row) {
      const double error = largest_error(map, p, row), bound = placing_error(map, abs(p), row);
      EXPECT_LE(error, bound);
      worst = std::max(worst, error / bound);
    }
  }
  EXPECT_GT(worst, 0.4);  // it is not much larger than need be
}

TEST(Placing, BoxesHoldWhatIsPlaced) {
  Random random(2);
  for (int n = 0; n < 2000; ++n) {
    const Affine map =
        random_map(kKinds[random.below(9)], random.below(2) == 0 ? 10.0f : 1e5f, random);
    const Vec3 far = random.in_box(random.below(2) == 0 ? 1.0f : 300.0f),
               size = abs(random.in_box(2));
    const Box box{far, far + size};
    const Box world = placed_box(make_placing(map, box), box);
    for (int k = 0; k < 20; ++k) {
      const auto pick = [&](int axis) {
        const float low = component(box.min, axis), high = component(box.max, axis);
        return random.below(3) == 0   ? low
               : random.below(2) == 0 ? high
                                      : low + (high - low) * random.unit();
      };
      const Vec3 q = transform_point(map, {pick(0), pick(1), pick(2)});
      EXPECT_EQ(max(world.max, q), world.max);
      EXPECT_EQ(min(world.min, q), world.min);
    }
  }
}

TEST(Motion, BoxesHoldWhatMoves) {
  Random random(12);
  for (int n = 0; n < 400; ++n) {
    const float reach = random.below(2) == 0 ? 4.0f : 1e5f;
    Instances instances;
    Soup soup = make_soup(Shape::kSmall, 20, random);
    for (Vec3& p : soup.positions) p = p * (random.below(2) == 0 ? 1.0f : 100.0f);
    instances.add_mesh(soup);
    instances.for_points = true;
    std::vector<Affine> motion;
    for (std::uint32_t k = 0; k < 2 + random.below(3); ++k)
      motion.push_back(random_map(kKinds[random.below(9)], reach, random));
    if (random.below(3) == 0)  // through nothing
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) motion[1].m[r][c] = -motion[0].m[r][c];
    instances.place(0, motion[0]);
    const BoxFit fit = random.below(2) == 0 ? BoxFit::kQuick : BoxFit::kClose;
    const Box box = world_box(instances.instances()[0], fit, View<const Affine>(motion));
    for (int k = 0; k < 40; ++k) {
      const float time =
          random.below(3) == 0 ? 0.5f / static_cast<float>(motion.size() - 1) : random.unit();
      const Affine map = affine_at(View<const Affine>(motion), time);
      for (const Vec3 p : soup.positions) {
        const Vec3 q = transform_point(map, p);
        EXPECT_EQ(max(box.max, q), box.max);
        EXPECT_EQ(min(box.min, q), box.min);
      }
    }
  }
}

/// A point of the world ray at s passes as near to p, seen from the mesh, as the bound says plus
/// how far it is from the image of p.
TEST(Placing, RaysPassThePointsWhoseImagesTheyMeet) {
  Random random(3);
  for (int n = 0; n < 20000; ++n) {
    const Affine map =
        random_map(kKinds[random.below(9)], random.below(2) == 0 ? 10.0f : 1e4f, random);
    const Vec3 p = random.in_box(3);
    const Placing placing = make_placing(map, {{-3, -3, -3}, {3, 3, 3}});
    if (!placing.may_enter) continue;
    const Vec3 q = transform_point(map, p),
               o = q + random.in_box(random.below(2) == 0 ? 20.0f : 1e4f);
    const Ray ray{o, 0, q - o, kInfinity};  // s = 1, except for the rounding of q - o
    const LongRay seen = in_mesh(placing, ray);
    double away = 0;
    for (int r = 0; r < 3; ++r) {
      const double off = std::fabs(static_cast<double>(component(o, r)) +
                                   component(ray.direction, r) - component(q, r));
      for (int k = 0; k < 3; ++k) away = std::max(away, 3 * std::fabs(placing.inverse[r][k]) * off);
    }
    for (int k = 0; k < 3; ++k)
      EXPECT_LE(std::fabs(seen.origin[k] + seen.direction[k] - component(p, k)), seen.error + away);
  }
}

TEST(Placing, RefusesMapsWithoutAGoodInverse) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_TRUE(make_placing(Affine(), box).may_enter);
  EXPECT_TRUE(make_placing(scaling({1e-6f, 1e-6f, 1e-6f}), box).may_enter);
  EXPECT_TRUE(make_placing(scaling({1, 0.01f, 1}), box).may_enter);
  EXPECT_FALSE(make_placing(scaling({1, 0, 1}), box).may_enter);
  EXPECT_FALSE(make_placing(scaling({0, 0, 0}), box).may_enter);
  EXPECT_FALSE(make_placing(translation({1e9f, 0, 0}), box).may_enter);
}

bool same_bits(View<const Hit> a, View<const Hit> b) {
  return a.size == b.size && (a.empty() || std::memcmp(a.data, b.data, a.size * sizeof(Hit)) == 0);
}

/// How many rays of a closest and an any-hit query differ from these hits.
std::size_t count_wrong(const Executor& executor, const LevelScene& scene,
                        const std::vector<Ray>& rays, const HitChoice& choice,
                        const std::vector<Hit>& right, const LevelWay& way) {
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size(), 2);
  DualCounts counts;
  trace_levels(executor, scene, View<const Ray>(rays), choice, {.hits = hits}, &counts, way);
  trace_levels(executor, scene, View<const Ray>(rays), choice, {.occluded = occluded}, nullptr,
               way);
  std::size_t wrong = 0;
  for (std::size_t r = 0; r < rays.size(); ++r) {
    const std::uint8_t met = right[r].prim_id != kInvalidId ? 1 : 0;
    wrong += same_bits({&hits[r], 1}, {&right[r], 1}) && occluded[r] == met ? 0 : 1;
  }
  return wrong;
}

constexpr LevelWay kWays[] = {{}, {Bundle::kStream}, {Bundle::kLongStream}};

/// The rows of `hits_of`, as two levels find them.
void expect_rows(Instances& instances, const LevelScene& scene, const std::vector<Ray>& rays,
                 const HitChoice& choice) {
  const View<const Ray> all(rays);
  std::vector<Hit> firsts(rays.size());
  std::vector<std::uint32_t> numbers(rays.size());
  LevelRows rows;
  trace_levels(instances.executor(), scene, all, choice, {.hit_counts = numbers}, nullptr);
  trace_levels(instances.executor(), scene, all, choice, {.rows = &rows}, nullptr);
  std::vector<std::vector<Hit>> found(rays.size(), std::vector<Hit>(1));
  rows.for_each(Executor(1), [&](std::size_t ray, View<const Hit> row) {
    found[ray].assign(row.begin(), row.end());
  });
  std::size_t differ = 0;
  for (std::uint32_t r = 0; r < rays.size(); ++r) {
    const std::vector<Hit> right = instances.hits_of(rays[r], r, choice);
    if (!right.empty()) firsts[r] = right[0];
    differ += numbers[r] == right.size() && same_bits(found[r], right) ? 0 : 1;
  }
  EXPECT_EQ(differ, 0u) << "of " << rays.size();
  for (const LevelWay& way : kWays)
    EXPECT_EQ(count_wrong(instances.executor(), scene, rays, choice, firsts, way), 0u);
}

/// All hits, and those of some instances, sides and triangles.
void expect_right(Instances& instances, const std::vector<Ray>& rays, bool refit = false) {
  const LevelScene scene = instances.scene(refit);
  expect_rows(instances, scene, rays, {});
  std::vector<std::uint32_t> masks(rays.size());
  std::vector<TriangleId> skips(rays.size());
  for (std::uint32_t r = 0; r < rays.size(); ++r) {
    masks[r] = r % 8;
    const std::vector<Hit> hits = instances.hits_of(rays[r], r, {});
    if (!hits.empty()) skips[r] = {hits[0].inst_id, hits[0].prim_id};
  }
  const Sides side = rays.size() % 3 == 0 ? Sides::kBack : Sides::kFront;
  expect_rows(instances, scene, rays, {5, side, nullptr, skips.data()});
  expect_rows(instances, scene, rays, {6, Sides::kBoth, masks.data(), skips.data()});
}

TEST(Levels, HaveTheHitsOfTheFlatScene) {
  Random random(4);
  for (const Shape shape : kShapes) {
    for (const float reach : {0.0f, 20.0f, 1e4f}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(shape) << " " << reach);
      Instances instances;
      fill_any(&instances, shape, reach, random);
      expect_right(instances, any_rays(instances.world, 600, random, 1 + 0.1f * reach));
      std::vector<Ray> rays = any_rays(instances.world, 200, random, 1e3f);
      keep_one_hit(instances.world, &rays, random);
      expect_right(instances, rays);
    }
  }
}

/// A tree that follows its instances has the hits of one that is built for them.
TEST(Levels, FollowTheirInstances) {
  Random random(6);
  for (const std::uint32_t count : {1u, 5u, 60u, 300u}) {
    SCOPED_TRACE(count);
    Instances instances;
    instances.add_mesh(make_soup(Shape::kSmall, 30, random));
    for (std::uint32_t i = 0; i < count; ++i)
      instances.place(0, random_map(Kind::kTurned, 50, random));
    static_cast<void>(instances.scene());
    instances.move_all([&] { return random_map(kKinds[1 + random.below(7)], 50, random); });
    expect_right(instances, any_rays(instances.world, 400, random, 5), true);
  }
}

/// Rays of one quarter and of one start, so many that lists of them enter.
TEST(Levels, TogetherHaveTheHitsOfTheFlatScene) {
  Random random(9);
  for (const float reach : {2.0f, 30.0f, 1e4f}) {
    for (const bool one_start : {false, true}) {
      SCOPED_TRACE(testing::Message() << reach << " " << one_start);
      Instances instances;
      fill_any(&instances, Shape::kSmall, reach, random);
      std::vector<Ray> rays = any_rays(instances.world, 3000, random, 1 + 0.1f * reach);
      if (one_start) start_at(random.in_box(2 * reach), 0, &rays);
      if (!one_start) turn_into_one_quarter(&rays);
      expect_right(instances, rays);
    }
  }
}

/// Without the bounds of the inverse and of placing, rays miss triangles that they hit.
TEST(Levels, AreWrongWithoutTheBoundsOfPlacing) {
  Random random(10);
  Instances instances;
  instances.add_mesh(make_soup(Shape::kLattice, 200, random));
  for (int i = 0; i < 8; ++i) instances.place(0, random_map(Kind::kTurned, 300, random));
  LevelScene scene = instances.scene();
  // At corners, where an edge that is missed is a hit that is missed.
  std::vector<Ray> rays;
  std::vector<Hit> right;
  for (std::uint32_t n = 0; n < 4000; ++n) {
    const Vec3 at = instances.world.corners(random.below(instances.world.count()))[n % 3];
    const Vec3 from = at + random.in_box(20);
    rays.push_back({from, 0, at - from, kInfinity});
    const std::vector<Hit> hits = instances.hits_of(rays[n], n, {});
    right.push_back(hits.empty() ? Hit() : hits[0]);
  }
  std::vector<LevelInstance> bold(instances.instances());
  for (LevelInstance& instance : bold)
    instance.placing.drift = instance.placing.per_origin = instance.placing.least_error = 0;
  for (const LevelWay& way : kWays) {
    EXPECT_EQ(count_wrong(instances.executor(), scene, rays, {}, right, way), 0u);
    LevelScene without = scene;
    without.instances = View<const LevelInstance>(bold);
    EXPECT_GT(count_wrong(instances.executor(), without, rays, {}, right, way), 0u);
  }
}

TEST(Levels, BoxesHoldInstances) {
  Random random(7);
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    for (const Shape shape : kShapes) {
      Instances instances;
      instances.add_mesh(make_soup(shape, 200, random));
      for (const Kind kind : kKinds) instances.place(0, random_map(kind, 20, random));
      for (std::size_t i = 0; i < instances.instances().size(); ++i) {
        for (const BoxFit fit : {BoxFit::kQuick, BoxFit::kClose}) {
          const Box box = world_box(instances.instances()[i], fit);
          const std::uint32_t first = instances.first_of(i), size = instances.mesh_of(i).count;
          for (std::uint32_t n = first; n < first + size; ++n)
            for (const Vec3 p : instances.world.corners(n))
              EXPECT_TRUE(distance_outside(p, box) <= 0) << i << " " << n;
        }
      }
    }
  });
}

TEST(Levels, TheSameOnEveryTarget) {
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    Random random(8);
    Instances instances;
    instances.add_mesh(make_soup(Shape::kLattice, 80, random));
    for (const Kind kind : kKinds) instances.place(0, random_map(kind, 3, random));
    expect_right(instances, any_rays(instances.world, 500, random, 5));
  });
}

TEST(Levels, SmallAndFarFromTheirOrigin) {
  Random random(5);
  for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
    for (const float offset : {0.0f, 30.0f}) {
      SCOPED_TRACE(testing::Message() << scale << " " << offset);
      Instances instances;
      fill_scaled(&instances, scale, offset, random);
      expect_right(instances, any_rays(instances.world, 600, random, scale));
      expect_right(instances, any_rays(instances.world, 300, random, 1e4f * scale));
      for (const float times : {1e-36f, 1e36f})
        expect_right(instances, lengthened(any_rays(instances.world, 100, random, scale), times));
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
