// Rays that enter instances on a device give brute force's answers on placed triangles, bit for
// bit: on an emulated device, and on a CUDA device if the machine has one.
#include <cstring>

#include "device/on_device.h"
#include "levels/instances.h"

namespace raysheaf::test {
namespace {

bool same_hits(View<const Hit> a, View<const Hit> b) {
  return a.size == b.size && (a.empty() || std::memcmp(a.data, b.data, a.size * sizeof(Hit)) == 0);
}

class LevelsOnDevice : public OnDevice {
 protected:
  /// Sends the instances to the engine.
  InstanceId send(Instances& instances, DeviceQueries* engine) {
    const std::vector<PlacedInstance> placed = instances.placed();
    const std::vector<LevelMark> marks = instances.marks();
    return engine->set_instances(executor_, View<const PlacedInstance>(placed),
                                 View<const LevelMark>(marks));
  }

  static void expect_rows(const Instances& instances, DeviceQueries& engine,
                          const std::vector<Ray>& rays, const HitChoice& choice) {
    DeviceQuery query;
    query.enters = true;
    query.filter.choice = choice;
    const View<const Ray> all(rays);
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size(), 7);
    std::vector<std::uint32_t> numbers(rays.size(), 99);
    engine.closest_hit(all, query, View<Hit>(hits));
    engine.any_hit(all, query, View<std::uint8_t>(occluded));
    engine.count_hits(all, query, View<std::uint32_t>(numbers));
    const DeviceRows<Hit> rows = engine.all_entered_hits(all, query);
    ASSERT_EQ(rows.offsets.size(), rays.size() + 1);
    std::size_t differ = 0;
    for (std::uint32_t r = 0; r < rays.size(); ++r) {
      const std::vector<Hit> right = instances.hits_of(rays[r], r, choice);
      const Hit first = right.empty() ? Hit() : right[0];
      const View<const Hit> row(rows.hits.data() + rows.offsets[r],
                                rows.offsets[r + 1] - rows.offsets[r]);
      const bool same = same_hits({&hits[r], 1}, {&first, 1}) &&
                        occluded[r] == (right.empty() ? 0 : 1) && numbers[r] == right.size() &&
                        same_hits(row, View<const Hit>(right));
      differ += same ? 0 : 1;
    }
    EXPECT_EQ(differ, 0u) << "of " << rays.size();
  }

  /// All hits, and those of some instances, sides and triangles.
  static void expect_right(const Instances& instances, DeviceQueries& engine,
                           const std::vector<Ray>& rays) {
    expect_rows(instances, engine, rays, {});
    std::vector<std::uint32_t> masks(rays.size());
    std::vector<TriangleId> skips(rays.size());
    for (std::uint32_t r = 0; r < rays.size(); ++r) {
      masks[r] = r % 8;
      const std::vector<Hit> hits = instances.hits_of(rays[r], r, {});
      if (!hits.empty()) skips[r] = {hits[0].inst_id, hits[0].prim_id};
    }
    expect_rows(instances, engine, rays, {5, Sides::kFront, nullptr, skips.data()});
    expect_rows(instances, engine, rays, {6, Sides::kBack, masks.data(), nullptr});
  }
};

TEST_P(LevelsOnDevice, HaveTheHitsOfPlacedTriangles) {
  Random random(1);
  for (const Shape shape : kShapes) {
    for (const float reach : {0.0f, 20.0f, 1e4f, 1e5f}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(shape) << " " << reach);
      Instances instances;
      fill_any(&instances, shape, reach, random);
      const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
      ASSERT_EQ(send(instances, engine.get()), kInvalidId);
      expect_right(instances, *engine, any_rays(instances.world, 150, random, 1 + 0.1f * reach));
      std::vector<Ray> rays = any_rays(instances.world, 50, random, 1e3f);
      keep_one_hit(instances.world, &rays, random);
      expect_right(instances, *engine, rays);
    }
  }
}

TEST_P(LevelsOnDevice, SmallLargeAndFarFromTheirOrigin) {
  Random random(2);
  for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
    for (const float offset : {0.0f, 30.0f}) {
      SCOPED_TRACE(testing::Message() << scale << " " << offset);
      Instances instances;
      fill_scaled(&instances, scale, offset, random);
      const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
      ASSERT_EQ(send(instances, engine.get()), kInvalidId);
      expect_right(instances, *engine, any_rays(instances.world, 300, random, scale));
      expect_right(instances, *engine, any_rays(instances.world, 200, random, 1e4f * scale));
      for (const float times : {1e-36f, 1e36f})
        expect_right(instances, *engine,
                     lengthened(any_rays(instances.world, 50, random, scale), times));
    }
  }
}

/// Meshes of one leaf and of many nodes, few and many instances, and rays that are sorted.
TEST_P(LevelsOnDevice, OfAllSizes) {
  Random random(3);
  for (const std::uint32_t count : {1u, 4u, 5u, 70u, 600u}) {
    SCOPED_TRACE(count);
    Instances instances;
    for (const std::uint32_t triangles : {1u, 4u, 5u, 700u})
      instances.add_mesh(make_soup(Shape::kSmall, triangles, random));
    for (std::uint32_t i = 0; i < count; ++i)
      instances.place(random.below(count < 600 ? 4 : 3), random_map(Kind::kTurned, 40, random));
    const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
    ASSERT_EQ(send(instances, engine.get()), kInvalidId);
    expect_right(instances, *engine, any_rays(instances.world, 100, random, 5));
  }
  Instances instances;
  instances.add_mesh(make_soup(Shape::kSmall, 20, random));
  for (int i = 0; i < 6; ++i) instances.place(0, random_map(Kind::kMirrored, 20, random));
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  ASSERT_EQ(send(instances, engine.get()), kInvalidId);
  expect_rows(instances, *engine, any_rays(instances.world, 4500, random), {});
}

TEST_P(LevelsOnDevice, FollowTheirInstances) {
  Random random(4);
  for (const std::uint32_t count : {1u, 5u, 200u}) {
    SCOPED_TRACE(count);
    Instances instances;
    instances.add_mesh(make_soup(Shape::kSmall, 30, random));
    for (std::uint32_t i = 0; i < count; ++i)
      instances.place(0, random_map(Kind::kTurned, 50, random));
    const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
    for (int step = 0; step < 4; ++step) {
      EXPECT_EQ(engine->missing_triangles(View<const PlacedInstance>(instances.placed())),
                step == 0 ? 30u : 0u);
      ASSERT_EQ(send(instances, engine.get()), kInvalidId);
      const std::vector<Ray> rays = any_rays(instances.world, 200, random, 5);
      QueryReport report;
      DeviceQuery query;
      query.enters = true;
      query.report = &report;
      std::vector<Hit> hits(rays.size());
      engine->closest_hit(View<const Ray>(rays), query, View<Hit>(hits));
      if (step == 0) {
        EXPECT_EQ(report.tree, TreeWork::kRebuild);
      } else if (step == 1) {
        EXPECT_EQ(report.tree, TreeWork::kRefit);
      }
      expect_right(instances, *engine, rays);
      instances.move_all([&] { return random_map(kKinds[1 + random.below(7)], 50, random); });
    }
  }
}

/// The second time, the meshes have no positions.
TEST_P(LevelsOnDevice, InstancesThatMoveReadNoVertex) {
  Random random(5);
  Instances instances;
  instances.add_mesh(make_soup(Shape::kSmall, 500, random));
  for (int i = 0; i < 20; ++i) instances.place(0, random_map(Kind::kTurned, 50, random));
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  ASSERT_EQ(send(instances, engine.get()), kInvalidId);
  instances.move_all([&] { return random_map(Kind::kTurned, 50, random); });
  std::vector<PlacedInstance> placed = instances.placed();
  for (PlacedInstance& one : placed) one.positions = {};
  const std::vector<LevelMark> marks = instances.marks();
  ASSERT_EQ(engine->set_instances(executor_, View<const PlacedInstance>(placed),
                                  View<const LevelMark>(marks)),
            kInvalidId);
  expect_right(instances, *engine, any_rays(instances.world, 200, random, 5));
}

TEST_P(LevelsOnDevice, NameTheInstanceThatRaysCannotEnter) {
  Random random(6);
  Instances instances;
  instances.for_points = true;
  instances.add_mesh(make_soup(Shape::kSmall, 30, random));
  for (int i = 0; i < 9; ++i)
    instances.place(0,
                    i == 4 || i == 7 ? scaling({1, 0, 1}) : random_map(Kind::kTurned, 9, random));
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  EXPECT_EQ(send(instances, engine.get()), 4u);
}

INSTANTIATE_TEST_SUITE_P(Emulated, LevelsOnDevice, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Cuda, LevelsOnDevice, testing::Values(true));

/// Whatever memory runs out, the next call finds an engine that answers.
TEST(DeviceLevels, MemoryThatRunsOutAnywhereLeavesTheEngineUsable) {
  Random random(7);
  Instances instances;
  instances.add_mesh(make_soup(Shape::kSmall, 40, random));
  instances.add_mesh(make_soup(Shape::kSmall, 3, random));
  for (int i = 0; i < 9; ++i)
    instances.place(random.below(2), random_map(Kind::kTurned, 20, random));
  const std::vector<PlacedInstance> placed = instances.placed();
  const std::vector<LevelMark> marks = instances.marks();
  const std::vector<Ray> rays = any_rays(instances.world, 100, random, 3);
  Emulation emulation;
  DeviceQuery query;
  query.enters = true;
  std::uint64_t failures = 0;
  for (std::uint64_t allowed = 0;; ++allowed) {
    const std::unique_ptr<DeviceQueries> engine = emulation.backend->make_queries();
    std::vector<Hit> hits(rays.size());
    const auto ask = [&] {
      ASSERT_EQ(engine->set_instances(emulation.executor, View<const PlacedInstance>(placed),
                                      View<const LevelMark>(marks)),
                kInvalidId);
      engine->closest_hit(View<const Ray>(rays), query, View<Hit>(hits));
    };
    bool failed = false;
    emulation.memory.let(allowed);
    try {
      ask();
    } catch (const Error& error) {
      failed = true;
      ++failures;
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
    }
    emulation.memory.let(FailingAllocator::kAlways);
    if (failed) ask();
    for (std::uint32_t r = 0; r < rays.size(); ++r) {
      const std::vector<Hit> right = instances.hits_of(rays[r], r, {});
      const Hit first = right.empty() ? Hit() : right[0];
      ASSERT_TRUE(same_hits({&hits[r], 1}, {&first, 1})) << r;
    }
    if (!failed) break;
  }
  EXPECT_GT(failures, 15u);
}

}  // namespace
}  // namespace raysheaf::test
