// Points on a device get brute force's answers bit for bit: on an emulated device, and on a CUDA
// device if the machine has one.
#include "device/on_device.h"
#include "nearest/inside.h"
#include "nearest/nearest_support.h"

namespace raysheaf::test {
namespace {

class PointsOnDevice : public OnDevice {
 protected:
  void expect_nearest(DeviceQueries& engine, Soup& soup, const std::vector<QueryPoint>& points,
                      std::uint32_t k, bool brute) {
    std::vector<FoundTriangle> expected;
    for (const QueryPoint& point : points) {
      const std::vector<FoundTriangle> nearest = nearest_by_brute_force(soup, point, k);
      expected.insert(expected.end(), nearest.begin(), nearest.end());
    }
    std::vector<ClosestPoint> found(points.size() * k);
    DeviceQuery query;
    query.brute = brute;
    query.executor = &executor_;
    engine.nearest(points, k, query, found);
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].prim_id, static_cast<std::uint32_t>(expected[i].triangle)) << i;
      ASSERT_TRUE(same_bits(found[i].distance, expected[i].distance)) << i;
      if (found[i].prim_id == kInvalidId) continue;
      ASSERT_EQ(found[i].geom_id, 5u);
      ASSERT_EQ(found[i].inst_id, 6u);
      ASSERT_GE(found[i].u, 0);
      ASSERT_LE(found[i].u, 1);
    }
  }

  void expect_signs(DeviceQueries& engine, Soup& soup, const std::vector<QueryPoint>& points,
                    bool brute) {
    for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd}) {
      std::vector<std::uint8_t> expected, inside(points.size());
      for (const QueryPoint& point : points)
        expected.push_back(inside_by_brute_force(soup, point.at, rule) ? 1 : 0);
      DeviceQuery query;
      query.brute = brute;
      query.rule = rule;
      query.closed = closedness_of(executor_, soup.source()).suits(rule);
      engine.contains(points, query, inside);
      ASSERT_EQ(inside, expected);
      std::vector<double> distances(points.size());
      engine.signed_distance(points, query, distances);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double distance = nearest_by_brute_force(soup, points[i], 1).front().distance;
        const double wanted = expected[i] != 0 && distance > 0 ? -distance : distance;
        ASSERT_TRUE(same_bits(distances[i], wanted)) << i;
      }
    }
  }

  void expect_answers(DeviceQueries& engine, Soup& soup, const std::vector<QueryPoint>& points) {
    for (const bool brute : {false, true}) {
      SCOPED_TRACE(brute ? "brute force" : "tree");
      for (const std::uint32_t k : {1u, 2u, 7u, 400u})
        expect_nearest(engine, soup, points, k, brute);
      expect_signs(engine, soup, points, brute);
    }
  }

  void expect_right(Soup soup, const std::vector<QueryPoint>& points) {
    const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
    engine->set_triangles(executor_, soup.source(), false);
    const RunName name{0, 5, 6};
    engine->set_names({&name, 1});
    expect_answers(*engine, soup, points);
  }
};

TEST_P(PointsOnDevice, AllShapes) {
  Random random(1);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Soup soup = make_soup(shape, 150, random);
    expect_right(soup, any_points(soup, 150, random));
  }
}

TEST_P(PointsOnDevice, ClosedSurfaces) {
  Random random(2);
  Soup soup;
  add_closed(8, &soup);
  expect_right(soup, any_points(soup, 500, random));
}

TEST_P(PointsOnDevice, FewTriangles) {
  Random random(3);
  for (const std::uint32_t triangles : {1u, 2u, 4u, 5u, 9u, 33u}) {
    SCOPED_TRACE(triangles);
    const Soup soup = make_soup(Shape::kLarge, triangles, random);
    expect_right(soup, any_points(soup, 100, random));
  }
}

TEST_P(PointsOnDevice, ScalesAndPlaces) {
  Random random(4);
  for (const float scale : {1e-30f, 1e-15f, 1e-4f, 1e4f, 1e9f, 1e13f}) {
    SCOPED_TRACE(scale);
    const Soup soup = make_soup(kShapes[random.below(7)], 60, random, scale);
    expect_right(soup, any_points(soup, 60, random, scale));
  }
}

TEST_P(PointsOnDevice, ManyPointsAndTriangles) {
  Random random(5);
  Soup soup = make_soup(Shape::kSmall, 600, random);
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  engine->set_triangles(executor_, soup.source(), false);
  const RunName name{0, 5, 6};
  engine->set_names({&name, 1});
  const std::vector<QueryPoint> points = any_points(soup, 5000, random);  // they are sorted
  expect_nearest(*engine, soup, points, 1, false);
  expect_nearest(*engine, soup, points, 3, false);
  expect_signs(*engine, soup, points, false);
}

TEST_P(PointsOnDevice, TrianglesThatMove) {
  Random random(6);
  Soup soup = make_soup(Shape::kLarge, 120, random);
  const std::unique_ptr<DeviceQueries> engine = backend_->make_queries();
  const RunName name{0, 5, 6};
  engine->set_names({&name, 1});
  for (int frame = 0; frame < 4; ++frame) {
    engine->set_triangles(executor_, soup.source(), frame > 0);
    const std::vector<QueryPoint> points = any_points(soup, 100, random);
    expect_nearest(*engine, soup, points, 3, false);
    QueryReport report;
    DeviceQuery query;
    query.report = &report;
    std::vector<double> distances(points.size());
    engine->signed_distance(points, query, distances);
    EXPECT_TRUE(report.used_tree);
    EXPECT_EQ(report.plan.size(), 2u);
    expect_signs(*engine, soup, points, false);
    for (Vec3& p : soup.positions) p += random.in_box(0.5f);
    for (std::size_t i = 0; i + 1 < soup.positions.size(); i += 19)
      soup.positions[i] = soup.positions[i + 1];
  }
}

INSTANTIATE_TEST_SUITE_P(Backend, PointsOnDevice, testing::Bool(), [](const auto& test) {
  return std::string(test.param ? "Cuda" : "Emulated");
});

TEST(PointsOnADevice, MemoryThatRunsOutAnywhereLeavesItUsable) {
  Emulation emulation;
  Random random(7);
  Soup soup = make_soup(Shape::kSmall, 30, random);
  const std::vector<QueryPoint> points = any_points(soup, 20, random);
  std::vector<double> expected(points.size());
  const auto ask = [&](DeviceQueries& engine) {
    std::vector<double> distances(points.size());
    std::vector<ClosestPoint> found(points.size() * 2);
    engine.signed_distance(points, {}, distances);
    engine.nearest(points, 2, {}, found);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_TRUE(same_bits(std::fabs(distances[i]), found[2 * i].distance));
    return distances;
  };
  const RunName name{0, 5, 6};
  std::uint64_t allowed = 0;
  for (bool failed = true; failed; ++allowed) {
    const std::unique_ptr<DeviceQueries> engine = emulation.backend->make_queries();
    failed = false;
    emulation.memory.let(allowed);
    try {
      engine->set_triangles(emulation.executor, soup.source(), false);
      engine->set_names({&name, 1});
      expected = ask(*engine);
    } catch (const Error& error) {
      failed = true;
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
    }
    emulation.memory.let(FailingAllocator::kAlways);
    engine->set_triangles(emulation.executor, soup.source(), false);
    engine->set_names({&name, 1});
    const std::vector<double> again = ask(*engine);
    if (!failed) {
      for (std::size_t i = 0; i < again.size(); ++i)
        EXPECT_TRUE(same_bits(again[i], expected[i])) << i;
    }
  }
  EXPECT_GT(allowed, 8u);
}

TEST(PointsOnADevice, PointsAndResultsMayLieInTheDevicesMemory) {
  Random random(8);
  Soup soup = make_soup(Shape::kSmall, 200, random);
  const std::vector<QueryPoint> points = any_points(soup, 3000, random);  // they are sorted
  // Every second row of four columns, and the coordinates in the order z, y, x.
  std::vector<double> rows(points.size() * 8), radii(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    rows[8 * i] = points[i].at.z;
    rows[8 * i + 1] = points[i].at.y;
    rows[8 * i + 2] = points[i].at.x;
    radii[i] = points[i].radius;
  }
  Emulation emulation;
  EmulatedDevice device(emulation.executor, emulation.soup);
  const DeviceBuffer<double> rows_there = to_device(device, rows);
  const DeviceBuffer<double> radii_there = to_device(device, radii);
  const std::unique_ptr<DeviceQueries> engine = emulation.backend->make_queries();
  engine->set_triangles(emulation.executor, soup.source(), false);
  const RunName name{0, 5, 6};
  engine->set_names({&name, 1});

  std::vector<ClosestPoint> found(points.size() * 2);
  std::vector<double> distances(points.size());
  std::vector<std::uint8_t> inside(points.size());
  engine->nearest(points, 2, {}, found);
  engine->signed_distance(points, {}, distances);
  engine->contains(points, {}, inside);

  DevicePoints there;
  there.count = points.size();
  there.rows = NumberRows(rows_there.data() + 2, 8, -1);
  there.radii = NumberRows(radii_there.data(), 1);
  DeviceBuffer<ClosestPoint> found_there(device.allocator());
  DeviceBuffer<double> distances_there(device.allocator());
  DeviceBuffer<std::uint8_t> inside_there(device.allocator());
  found_there.resize_uninitialized("test", found.size());
  distances_there.resize_uninitialized("test", points.size());
  inside_there.resize_uninitialized("test", points.size());
  engine->nearest(there, 2, {}, found_there.view());
  engine->signed_distance(there, {}, distances_there.view());
  engine->contains(there, {}, inside_there.view());
  const auto same = [](const auto& a, const auto& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
  };
  EXPECT_TRUE(same(to_host(device, found_there), found));
  EXPECT_TRUE(same(to_host(device, distances_there), distances));
  EXPECT_EQ(to_host(device, inside_there), inside);

  rows[8 * 77 + 1] = std::numeric_limits<double>::infinity();
  rows[8 * 300] = 2e18;
  radii[40] = -1;
  const DeviceBuffer<double> wrong_rows = to_device(device, rows);
  const DeviceBuffer<double> wrong_radii = to_device(device, radii);
  there.first = 1000;
  const auto expect_wrong = [&](const std::string& place) {
    try {
      engine->contains(there, {}, inside_there.view());
      FAIL() << "a wrong point passed";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
      EXPECT_EQ(error.place(), place);
    }
  };
  there.rows = NumberRows(wrong_rows.data() + 2, 8, -1);
  expect_wrong("points[1077]");
  there.radii = NumberRows(wrong_radii.data(), 1);
  expect_wrong("radii[1040]");
}

}  // namespace
}  // namespace raysheaf::test
