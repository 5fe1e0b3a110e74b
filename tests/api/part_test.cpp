// Instances that move among others that stand still: rays go through the placed triangles of these,
// and enter what moves. The answers are those of brute force, whatever has happened before.
#include <algorithm>
#include <cmath>

#include "api/api_support.h"
#include "raysheaf/points.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

constexpr const char* kInPart = "; the others, ";

Affine any_spot(Random& random) {
  Affine map = rotation(random.direction(), random.between(-3, 3));
  if (random.below(5) == 0) map = compose(map, scaling({1, -0.5f, 2}));
  if (random.below(20) == 0) map = scaling({1, 0, 1});  // flat: rays cannot enter it
  const Vec3 to = random.in_box(4);
  map.m[0][3] = to.x, map.m[1][3] = to.y, map.m[2][3] = to.z;
  return random.below(12) == 0 ? Affine() : map;
}

/// Ground, and things on it, of which some move from time to time. Many share corners and planes,
/// so that hits tie.
class MovingYard {
 public:
  explicit MovingYard(Random* random) : random_(*random) {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    const std::uint32_t side = 16;
    for (std::uint32_t i = 0; i <= side; ++i)
      for (std::uint32_t k = 0; k <= side; ++k)
        positions.push_back({static_cast<float>(i) - 8, static_cast<float>(k) - 8,
                             random->below(3) == 0 ? -1 : random->between(-2, -1)});
    for (std::uint32_t i = 0; i < side; ++i)
      for (std::uint32_t k = 0; k < side; ++k) {
        const std::uint32_t a = i * (side + 1) + k, b = a + side + 1;
        triangles.push_back({a, b, a + 1});
        triangles.push_back({b, b + 1, a + 1});
      }
    ground_ = scene.add(positions, triangles);
    soup_ = scene.add_soup(RandomSoup(160, 0).positions, {.place = false});
    const Cube cube;
    cube_ = scene.add(cube.positions, cube.triangles, {.place = false});
    for (int i = 0; i < 8; ++i) add();
    scene.commit();
  }

  void step() {
    const std::vector<InstanceId> all = instances();
    const auto one = [&] { return all[random_.below(static_cast<std::uint32_t>(all.size()))]; };
    switch (random_.below(12)) {
      case 0:
        add();
        break;
      case 1:
        if (all.size() > 4) scene.remove_instance(one());
        break;
      case 2:
        scene.set_mask(one(), 1u << random_.below(3));
        break;
      case 3:
        scene.set_world(one(), any_world());
        break;
      case 4:
        scene.update(soup_, RandomSoup(160, 0, random_.between(0.5f, 1)).positions);
        break;
      case 5: {
        const InstanceId moves = one();
        const Affine maps[] = {any_spot(random_), any_spot(random_)};
        scene.set_transforms({&moves, 1}, maps, 2);
        break;
      }
      case 6:
        scene = scene.copy();
        break;
      case 7:
        scene.set_transform(one(), any_spot(random_));  // the ground, perhaps
        break;
      case 8:
        break;  // all stand still
      default:
        for (const InstanceId id : {all.back(), all[all.size() - 2]})
          scene.set_transform(id, any_spot(random_));
    }
    scene.commit();
  }
  [[nodiscard]] WorldId any_world() {
    return random_.below(2) == 0 ? kAllWorlds : WorldId{random_.below(3)};
  }
  [[nodiscard]] std::vector<InstanceId> instances() const {
    std::vector<InstanceId> all;
    for (const MeshId mesh : scene.meshes())
      for (const InstanceId instance : scene.instances(mesh)) all.push_back(instance);
    std::ranges::sort(all);
    return all;
  }

  Scene scene = Scene(Context({.threads = 2}));

 private:
  void add() {
    const MeshId mesh = random_.below(3) == 0 ? cube_ : soup_;
    static_cast<void>(scene.instance(mesh, any_spot(random_), 1u << random_.below(3),
                                     random_.below(3) == 0 ? any_world() : kAllWorlds));
  }

  Random& random_;
  MeshId ground_ = 0, soup_ = 0, cube_ = 0;
};

/// Rays, and options for each of them.
struct AskedRays {
  std::vector<Ray> rays;
  std::vector<std::uint32_t> masks;
  std::vector<TriangleId> skip;
  std::vector<WorldId> worlds;
  std::vector<float> times;
  QueryOptions options;

  AskedRays(MovingYard* yard, Random& random) {
    constexpr std::uint32_t kCounts[] = {1, 5, 40, 150, 700};
    const std::uint32_t count = kCounts[random.below(5)];
    const std::vector<InstanceId> all = yard->instances();
    while (rays.size() < count) {
      Ray ray{random.in_box(6), 0, random.direction(), random.below(4) == 0 ? 4 : kInfinity};
      // Along the sides of cubes and the edges of the ground.
      if (random.below(3) == 0) ray.origin = floor(ray.origin);
      if (random.below(3) == 0) ray.direction = floor(ray.direction * 2);
      if (ray.direction.x == 0 && ray.direction.y == 0 && ray.direction.z == 0) continue;
      rays.push_back(ray);
      masks.push_back(random.bits());
      skip.push_back({all[random.below(static_cast<std::uint32_t>(all.size()))], random.below(9)});
      worlds.push_back(yard->any_world());
      times.push_back(static_cast<float>(random.below(5)) / 4);
    }
    if (random.below(3) == 0) options.mask = 1 + random.below(7);
    if (random.below(4) == 0) options.sides = random.below(2) == 0 ? Sides::kFront : Sides::kBack;
    if (random.below(4) == 0) options.ray_masks = masks;
    if (random.below(4) == 0) options.skip = skip;
    if (random.below(3) == 0) options.ray_worlds = worlds;
    if (random.below(3) == 0) options.ray_times = times;
  }
  static Vec3 floor(Vec3 p) { return {std::floor(p.x), std::floor(p.y), std::floor(p.z)}; }
};

/// Returns whether rays have entered a part of the instances.
bool expect_as_brute(const Scene& scene, const AskedRays& asked) {
  QueryStatistics statistics;
  QueryOptions options = asked.options;
  options.statistics = &statistics;
  const std::vector<Hit> hits = closest_hit(scene, asked.rays, options);
  const bool in_part =
      !statistics.plan.empty() && statistics.plan[0].find(kInPart) != std::string::npos;
  const std::vector<std::uint8_t> occluded = any_hit(scene, asked.rays, options);
  const std::vector<std::uint32_t> counts = hit_counts(scene, asked.rays, options);
  const HitRows all = all_hits(scene, asked.rays, options);
  const HitRows first = first_hits(scene, asked.rays, 2, options);
  options.method = QueryMethod::kBrute;
  const HitRows rows = all_hits(scene, asked.rays, options);
  for (std::size_t i = 0; i < asked.rays.size(); ++i) {
    const Hit nearest = rows[i].empty() ? Hit{} : rows[i].front();
    EXPECT_TRUE(same(hits[i], nearest)) << shown(hits[i]) << ", not " << shown(nearest);
    EXPECT_EQ(occluded[i], rows[i].empty() ? 0 : 1);
    EXPECT_EQ(counts[i], rows[i].size());
    EXPECT_TRUE(std::ranges::equal(all[i], rows[i], same));
    EXPECT_EQ(first[i].size(), std::min<std::size_t>(2, rows[i].size()));
    EXPECT_TRUE(std::ranges::equal(first[i], rows[i].first(first[i].size()), same));
    if (testing::Test::HasFailure()) break;
  }
  return in_part;
}

TEST(Part, EveryHistoryHasTheHitsOfBruteForce) {
  int in_part = 0, times = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    MovingYard yard(&random);
    for (int step = 0; step < 30; ++step) {
      SCOPED_TRACE(testing::Message() << seed << ", step " << step);
      yard.step();
      for (std::uint32_t query = 1 + random.below(3); query != 0; --query, ++times)
        in_part += expect_as_brute(yard.scene, AskedRays(&yard, random)) ? 1 : 0;
      if (random.below(3) == 0) {
        const std::vector<Vec3> points{random.in_box(5), random.in_box(5)};
        const auto found = nearest(yard.scene, points, 3);
        const auto right = nearest(yard.scene, points, 3, {.method = QueryMethod::kBrute});
        for (std::size_t i = 0; i < found.size(); ++i) {
          EXPECT_EQ(found[i].distance, right[i].distance);
          EXPECT_EQ(found[i].inst_id, right[i].inst_id);
          EXPECT_EQ(found[i].prim_id, right[i].prim_id);
        }
      }
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(in_part, times / 4) << times;
}

TEST(Part, OnEverySimdTarget) {
  Random random(9);
  MovingYard yard(&random);
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    for (int step = 0; step < 6; ++step) {
      yard.step();
      static_cast<void>(expect_as_brute(yard.scene, AskedRays(&yard, random)));
    }
  });
}

/// The plan's first sentence for so many rays.
std::string first_sentence(const Scene& scene, std::size_t count,
                           std::span<const float> times = {}) {
  QueryStatistics statistics;
  QueryOptions options;
  options.statistics = &statistics;
  options.ray_times = times;
  static_cast<void>(any_hit(scene, RandomSoup(1, count).rays, options));
  return statistics.plan[0];
}

TEST(Part, WhatMovesIsEnteredAndWhatStandsStillStaysPlaced) {
  Scene scene(Context({.threads = 2}));
  scene.add_soup(RandomSoup(20000, 0).positions);
  const MeshId mesh = scene.add_soup(RandomSoup(2000, 0).positions, {.place = false});
  const InstanceId moves = scene.instance(mesh, translation({0, 0, 1}));
  static_cast<void>(scene.instance(mesh, translation({1, 0, 1})));
  scene.commit();
  EXPECT_FALSE(first_sentence(scene, 100).starts_with("instances: ")) << first_sentence(scene, 100);
  const std::string in_part = "triangles; the others, 22000 triangles, are placed";
  for (int frame = 0; frame < 60; ++frame) {
    scene.set_transform(moves, translation({0, 0, static_cast<float>(frame)}));
    scene.commit();
    // The tree of the mesh is built when it has paid.
    const std::string plan = first_sentence(scene, 100);
    EXPECT_TRUE(frame < 10 || plan.find(in_part) != std::string::npos) << frame << ": " << plan;
  }
  // While it stands, its rays pay for placing it.
  int queries = 0;
  while (first_sentence(scene, 100).find(in_part) != std::string::npos && queries < 1000) ++queries;
  EXPECT_GT(queries, 2);
  EXPECT_LT(queries, 100);
  // Rays with times enter what moves meanwhile, and nothing else.
  const std::vector<float> times(3000, 0.5f);
  EXPECT_FALSE(first_sentence(scene, 3000, times).starts_with("instances: "));
  scene.set_transform(moves, translation({0, 0, 1}), translation({0, 0, 2}));
  scene.commit();
  EXPECT_EQ(first_sentence(scene, 3000, times),
            "instances: entered by the rays where they stand, because rays have times; the others, "
            "22000 triangles, are placed");
}

}  // namespace
}  // namespace raysheaf::test
