// Queries on a device give brute force's answers bit for bit: on an emulated device, and on a CUDA
// device if the machine has one.
#include "device/device_queries.h"
#include "device/on_device.h"
#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

class RaysOnDevice : public OnDevice {
 protected:
  struct Asked {
    bool brute = false, count = false;
    Facing facing = Facing::kBoth;
  };

  /// Whether the four queries of an engine agree with `rows`.
  static testing::AssertionResult says(DeviceQueries& engine, const HitRows& rows,
                                       const std::vector<Ray>& rays, const Asked& asked) {
    Answers a;
    DeviceQuery query;
    query.brute = asked.brute;
    query.facing = asked.facing;
    const View<const Ray> view(rays);
    a.closest.assign(rays.size(), {-1, -1, -1, 7});
    a.any.assign(rays.size(), 7);
    engine.closest_hit(view, query, View<IndexedHit>(a.closest));
    engine.any_hit(view, query, View<std::uint8_t>(a.any));
    std::vector<std::uint32_t> counts(rays.size(), 99);
    engine.count_hits(view, query, View<std::uint32_t>(counts));
    const DeviceHitRows found = engine.all_hits(view, query);
    if (found.offsets.size() != rays.size() + 1) return testing::AssertionFailure() << "offsets";
    for (std::size_t r = 0; r < rays.size(); ++r) {
      a.all.emplace_back(found.hits.begin() + static_cast<std::ptrdiff_t>(found.offsets[r]),
                         found.hits.begin() + static_cast<std::ptrdiff_t>(found.offsets[r + 1]));
      if (counts[r] != rows[r].size()) return testing::AssertionFailure() << "count of ray " << r;
    }
    return right(rows, a, rays);
  }

  /// Returns the number of hits.
  std::size_t expect_right(Soup soup, const std::vector<Ray>& rays, Facing facing = Facing::kBoth) {
    const HitRows rows = brute_force(soup, rays, facing);
    const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
    engine->set_triangles(executor_, soup.source(), false);
    EXPECT_TRUE(says(*engine, rows, rays, {true, false, facing})) << "brute force";
    EXPECT_TRUE(says(*engine, rows, rays, {false, false, facing}));
    return hit_count(rows);
  }
};

TEST_P(RaysOnDevice, AllShapes) {
  Random random(1);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Soup soup = make_soup(shape, 300, random);
    EXPECT_GT(expect_right(soup, any_rays(soup, 600, random)), 20u);
    std::vector<Ray> rays = any_rays(soup, 200, random);
    keep_one_hit(soup, &rays, random);
    expect_right(soup, rays);
  }
}

TEST_P(RaysOnDevice, FewTrianglesAndManyRays) {
  Random random(2);
  for (const std::uint32_t triangles : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 17u, 33u}) {
    SCOPED_TRACE(triangles);
    const Soup soup = make_soup(Shape::kLarge, triangles, random);
    const Soup aim = make_soup(Shape::kLarge, 8, random);
    expect_right(soup, any_rays(triangles > 0 ? soup : aim, 300, random));
  }
  const Soup soup = make_soup(Shape::kSmall, 40, random);
  for (const std::size_t rays : {std::size_t{0}, std::size_t{1}, std::size_t{5000}}) {
    expect_right(soup, any_rays(soup, rays, random));  // 5000 rays are sorted
  }
}

TEST_P(RaysOnDevice, ManyTriangles) {
  Random random(3);
  const Soup soup = make_soup(Shape::kSmall, 6000, random);
  EXPECT_GT(expect_right(soup, any_rays(soup, 200, random)), 20u);
}

TEST_P(RaysOnDevice, ScalesPlacesAndLengths) {
  Random random(4);
  for (const float scale : {1e-30f, 1e-15f, 1e-9f, 1e-4f, 1e4f, 1e9f, 1e15f, 6e16f}) {
    SCOPED_TRACE(scale);
    const Shape shape = kShapes[random.below(7)];
    const Soup soup = make_soup(shape, 60, random, scale);
    expect_right(soup, any_rays(soup, 100, random, scale));
  }
  for (const float far : {1e3f, 1e6f, 1e7f, 1e12f}) {
    SCOPED_TRACE(far);
    const Vec3 offset{far, -0.7f * far, 0.3f * far};
    const Soup soup = make_soup(kShapes[random.below(7)], 60, random, 0.3f, offset);
    expect_right(soup, any_rays(soup, 100, random, 0.3f, offset));
  }
  for (const float length : {1e-44f, 1e-41f, 3e-39f, 1e-37f, 1e-30f, 1e-15f, 1e15f, 1e30f, 1e37f}) {
    SCOPED_TRACE(length);
    const Soup soup = make_soup(kShapes[random.below(7)], 60, random);
    std::vector<Ray> rays = any_rays(soup, 200, random);
    for (Ray& ray : rays) {
      ray.direction = ray.direction * (1 / max_component(abs(ray.direction))) * length;
      if (!(max_component(abs(ray.direction)) > 0)) ray.direction = {0, length, 0};
      if (ray.t_max == 1) ray.t_max = 1 / length;
      if (ray.t_min == 1) ray.t_min = std::min(ray.t_max, 1 / length);
    }
    expect_right(soup, rays);
    keep_one_hit(soup, &rays, random);
    expect_right(soup, rays);
  }
}

TEST_P(RaysOnDevice, EqualTrianglesAndNoArea) {
  Random random(5);
  Soup soup = make_soup(Shape::kLarge, 30, random);
  const std::vector<Vec3> once = soup.positions;
  for (int copy = 0; copy < 5; ++copy)  // keys that differ only in the triangle's number
    soup.positions.insert(soup.positions.end(), once.begin(), once.end());
  for (int i = 0; i < 20; ++i) soup.add({1, 2, 3}, {1, 2, 3}, {1, 2, 3});
  for (int i = 0; i < 20; ++i) soup.add({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
  EXPECT_GT(expect_right(soup, any_rays(soup, 400, random)), 100u);
}

TEST_P(RaysOnDevice, CulledSides) {
  Random random(6);
  Soup soup = make_soup(Shape::kSmall, 200, random);
  for (std::uint32_t i = 0; i < soup.count(); ++i)
    soup.flags.push_back(static_cast<std::uint8_t>(random.below(4)));
  const std::vector<Ray> rays = any_rays(soup, 400, random);
  const std::size_t both = expect_right(soup, rays);
  EXPECT_LT(expect_right(soup, rays, Facing::kSkipBackOfSingleSided), both);
}

TEST_P(RaysOnDevice, TrianglesThatChange) {
  Random random(7);
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  for (const std::uint32_t triangles : {50u, 500u, 3u, 0u, 120u}) {
    Soup soup = make_soup(Shape::kLarge, triangles, random);
    const Soup aim = make_soup(Shape::kLarge, 8, random);
    const std::vector<Ray> rays = any_rays(triangles > 0 ? soup : aim, 200, random);
    const HitRows rows = brute_force(soup, rays);
    engine->set_triangles(executor_, soup.source(), false);
    for (int round = 0; round < 2; ++round)
      EXPECT_TRUE(says(*engine, rows, rays, {})) << triangles << " triangles, round " << round;
  }
}

/// The work on its tree that the engine did to answer a query of 64 rays.
TreeWork tree_work(DeviceQueries& engine, const std::vector<Ray>& rays) {
  QueryReport report;
  DeviceQuery query;
  query.report = &report;
  std::vector<IndexedHit> hits(rays.size());
  engine.closest_hit(View<const Ray>(rays), query, View<IndexedHit>(hits));
  EXPECT_TRUE(report.used_tree);
  return report.tree;
}

TEST_P(RaysOnDevice, TrianglesThatMoveLeaveTheTreeItsNodes) {
  Random random(11);
  for (const std::uint32_t triangles : {700u, 40u, 5u, 4u, 1u, 0u}) {
    SCOPED_TRACE(triangles);
    Soup soup = make_soup(Shape::kSmall, triangles, random);
    for (std::uint32_t i = 0; i < triangles; ++i)
      soup.flags.push_back(static_cast<std::uint8_t>(random.below(4)));
    const Soup aim = make_soup(Shape::kLarge, 8, random);
    const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
    engine->set_triangles(executor_, soup.source(), true);
    for (int frame = 0; frame < 6; ++frame) {
      const std::vector<Ray> rays = any_rays(triangles > 0 ? soup : aim, 150, random);
      EXPECT_EQ(tree_work(*engine, rays), frame == 0 ? TreeWork::kRebuild : TreeWork::kRefit);
      for (const Facing facing : {Facing::kBoth, Facing::kSkipBackOfSingleSided})
        EXPECT_TRUE(says(*engine, brute_force(soup, rays, facing), rays, {false, false, facing}));
      EXPECT_EQ(tree_work(*engine, rays), TreeWork::kKeep);
      const Vec3 step = random.in_box(0.3f);
      for (Vec3& p : soup.positions) p = p * 1.02f + step + random.in_box(0.002f);
      engine->set_triangles(executor_, soup.source(), true);
      // Triangles move twice before a query, and other sides become visible.
      if (frame == 2) engine->set_triangles(executor_, soup.source(), true);
      if (frame == 3) std::reverse(soup.flags.begin(), soup.flags.end());
      if (frame == 3) engine->set_triangles(executor_, soup.source(), true);
    }
    // The same number of triangles, but different ones.
    engine->set_triangles(executor_, soup.source(), false);
    EXPECT_EQ(tree_work(*engine, any_rays(aim, 9, random)), TreeWork::kRebuild);
    // Different triangles that are reported as the same.
    Soup more = make_soup(Shape::kSmall, triangles + 9, random);
    engine->set_triangles(executor_, more.source(), true);
    EXPECT_EQ(tree_work(*engine, any_rays(aim, 9, random)), TreeWork::kRebuild);
    const std::vector<Ray> rays = any_rays(more, 150, random);
    EXPECT_TRUE(says(*engine, brute_force(more, rays), rays, {}));
  }
}

TEST_P(RaysOnDevice, ATreeIsRebuiltWhenItsTrianglesHaveSpread) {
  Random random(12);
  Soup soup = make_soup(Shape::kSmall, 600, random);
  const std::vector<Ray> rays = any_rays(soup, 150, random);
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  engine->set_triangles(executor_, soup.source(), false);
  EXPECT_EQ(tree_work(*engine, rays), TreeWork::kRebuild);
  // Permutes the triangles: the boxes of all nodes become as large as the scene.
  for (std::uint32_t i = soup.count(); --i > 0;) {
    const std::uint32_t j = random.below(i + 1);
    for (std::uint32_t k = 0; k < 3; ++k)
      std::swap(soup.positions[3 * i + k], soup.positions[3 * j + k]);
  }
  engine->set_triangles(executor_, soup.source(), true);
  EXPECT_EQ(tree_work(*engine, rays), TreeWork::kRefit)
      << "the engine has not measured the tree yet";
  EXPECT_EQ(tree_work(*engine, rays), TreeWork::kRebuild) << "though nothing has moved since";
  EXPECT_EQ(tree_work(*engine, rays), TreeWork::kKeep);
  engine->set_triangles(executor_, soup.source(), true);
  EXPECT_EQ(tree_work(*engine, rays), TreeWork::kRefit);
  EXPECT_EQ(tree_work(*engine, rays), TreeWork::kKeep);
  EXPECT_TRUE(says(*engine, brute_force(soup, rays), rays, {}));
}

TEST_P(RaysOnDevice, ReportsWhatItDid) {
  Random random(8);
  Soup soup = make_soup(Shape::kSmall, 1000, random);
  const std::vector<Ray> rays = any_rays(soup, 5000, random);
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  engine->set_triangles(executor_, soup.source(), false);
  std::vector<IndexedHit> hits(rays.size());
  const auto ask = [&](bool brute, bool count) {
    QueryReport report;
    DeviceQuery query;
    query.brute = brute;
    query.count = count;
    query.report = &report;
    engine->closest_hit(View<const Ray>(rays), query, View<IndexedHit>(hits));
    return report;
  };
  const QueryReport first = ask(false, true), second = ask(false, true);
  EXPECT_NE(first.plan[0], second.plan[0]) << "the second keeps the tree";
  EXPECT_GT(first.hierarchy_ms, 0);
  EXPECT_EQ(second.hierarchy_ms, 0);
  EXPECT_GT(second.order_ms, 0);
  EXPECT_GT(second.trace_ms, 0);
  EXPECT_GE(second.total_ms, 0);
  EXPECT_GT(first.tests(), rays.size());
  EXPECT_EQ(first.tests(), second.tests());
  EXPECT_LT(first.tests(), rays.size() * 100) << "the tree does not prune";
  EXPECT_EQ(ask(false, false).tests(), 0u);
  EXPECT_EQ(ask(true, true).triangle_tests, std::uint64_t{5000} * soup.count());
  EXPECT_FALSE(engine->stage_times().empty());
}

INSTANTIATE_TEST_SUITE_P(Emulated, RaysOnDevice, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Cuda, RaysOnDevice, testing::Values(true));

TEST(DeviceQueries, MemoryThatRunsOutAnywhereLeavesTheEngineUsable) {
  Random random(9);
  Soup soup = make_soup(Shape::kSmall, 200, random);
  const std::vector<Ray> rays = any_rays(soup, 4500, random);
  const HitRows rows = brute_force(soup, rays);
  Emulation emulation;
  std::uint64_t failures = 0;
  for (const bool brute : {false, true}) {
    for (std::uint64_t allowed = 0;; ++allowed) {
      const std::unique_ptr<DeviceQueries> engine = emulation.backend->make_queries();
      DeviceQuery query;
      query.brute = brute;
      DeviceHitRows found;
      std::vector<IndexedHit> hits(rays.size());
      bool failed = false;
      emulation.memory.let(allowed);
      try {
        engine->set_triangles(emulation.executor, soup.source(), false);
        found = engine->all_hits(View<const Ray>(rays), query);
        engine->closest_hit(View<const Ray>(rays), query, View<IndexedHit>(hits));
      } catch (const Error& error) {
        failed = true;
        ++failures;
        EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
        EXPECT_NE(error.place().find(": "), std::string::npos) << "a stage: " << error.place();
      }
      emulation.memory.let(FailingAllocator::kAlways);
      if (failed) engine->set_triangles(emulation.executor, soup.source(), false);
      found = engine->all_hits(View<const Ray>(rays), query);
      EXPECT_EQ(found.hits.size(), hit_count(rows));
      engine->closest_hit(View<const Ray>(rays), query, View<IndexedHit>(hits));
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const IndexedHit least = rows[i].empty() ? IndexedHit{} : rows[i].front();
        ASSERT_TRUE(same_bits(hits[i], least)) << i;
      }
      if (!failed) break;
    }
    EXPECT_EQ(emulation.memory.alive(), 0u);
  }
  EXPECT_GT(failures, 15u);
}

TEST(DeviceQueries, RaysAndResultsMayLieInTheDevicesMemory) {
  Random random(10);
  Soup soup = make_soup(Shape::kSmall, 200, random);
  std::vector<Ray> rays = any_rays(soup, 500, random);
  const HitRows rows = brute_force(soup, rays);
  Emulation emulation;
  EmulatedDevice device(emulation.executor, emulation.soup);
  const DeviceBuffer<Ray> there = to_device(device, rays);
  DeviceBuffer<IndexedHit> hits(device.allocator());
  hits.resize_uninitialized("test", rays.size());
  const std::unique_ptr<DeviceQueries> engine = emulation.backend->make_queries();
  engine->set_triangles(emulation.executor, soup.source(), false);
  DeviceQuery query;
  query.check = true;
  engine->closest_hit(there.view_const(), query, hits.view());
  const std::vector<IndexedHit> found = to_host(device, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const IndexedHit least = rows[i].empty() ? IndexedHit{} : rows[i].front();
    ASSERT_TRUE(same_bits(found[i], least)) << i;
  }
  rays[77].t_min = -1;
  rays[300].direction = {0, 0, 0};
  const DeviceBuffer<Ray> wrong = to_device(device, rays);
  try {
    engine->closest_hit(wrong.view_const(), query, hits.view());
    FAIL() << "a wrong ray passed";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
    EXPECT_EQ(error.place(), "rays[77].t_min");
  }
}

}  // namespace
}  // namespace raysheaf::test
