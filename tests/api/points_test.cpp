// Point queries of the library: equal to brute force whatever the scene has gone through, and
// exactly what their header says.
#include "raysheaf/points.h"

#include <cstring>

#include "api/api_support.h"

namespace raysheaf::test {
namespace {

using Point3 = std::array<double, 3>;

/// Bit for bit.
template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

std::vector<Point3> some_points(std::size_t count, Random& random) {
  std::vector<Point3> points;
  while (points.size() < count) {
    const Vec3 p = random.in_box(3), q = random.in_box(1e-9f);
    points.push_back({double{p.x} + q.x, double{p.y} + q.y, double{p.z} + q.z});
  }
  return points;
}

/// All queries by both methods; returns how many points are inside.
std::size_t expect_equal(const Scene& scene, const PointParts& points, PointOptions options = {}) {
  PointOptions brute = options;
  brute.method = QueryMethod::kBrute;
  const auto found = closest_point(scene, points, options);
  EXPECT_TRUE(same_bytes(found, closest_point(scene, points, brute)));
  EXPECT_TRUE(same_bytes(nearest(scene, points, 4, options), nearest(scene, points, 4, brute)));
  EXPECT_TRUE(same_bytes(nearest(scene, points, 1, options), found));
  std::size_t count = 0;
  for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd}) {
    options.inside = brute.inside = rule;
    const auto inside = contains(scene, points, options);
    const auto distances = signed_distance(scene, points, options);
    EXPECT_TRUE(same_bytes(inside, contains(scene, points, brute)));
    EXPECT_TRUE(same_bytes(distances, signed_distance(scene, points, brute)));
    for (std::size_t i = 0; i < inside.size(); ++i) {
      EXPECT_EQ(std::fabs(distances[i]), found[i].distance);
      EXPECT_EQ(std::signbit(distances[i]), inside[i] != 0 && found[i].distance > 0);
    }
    count += static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1));
  }
  return count;
}

TEST(Points, NearACube) {
  const Cube cube;
  Scene scene;
  scene.add(cube.positions, cube.triangles);
  scene.commit();
  const std::vector<Point3> points{
      {0, 0, 0}, {0, 0.25, 3}, {-2, -2, -2}, {1, 0.5, 0.25}, {0.5, 0, 0}};
  const auto found = closest_point(scene, points);
  EXPECT_EQ(found[0].distance, 1);
  EXPECT_EQ(found[0].prim_id, 0u);
  EXPECT_EQ(found[0].side, -1);
  EXPECT_EQ(found[1].distance, 2);
  EXPECT_EQ(found[1].point, (Point3{0, 0.25, 1}));
  EXPECT_EQ(found[1].side, 1);
  EXPECT_EQ(found[2].distance, std::sqrt(3.0));
  EXPECT_EQ(found[2].point, (Point3{-1, -1, -1}));
  EXPECT_EQ(found[2].prim_id, 0u);
  EXPECT_EQ(found[3].distance, 0);
  EXPECT_EQ(found[3].side, 0);
  EXPECT_EQ(found[3].geom_id, 0u);
  EXPECT_EQ(found[3].inst_id, 0u);
  EXPECT_EQ(signed_distance(scene, points), (std::vector<double>{-1, 2, std::sqrt(3.0), 0, -0.5}));
  EXPECT_EQ(contains(scene, points), (std::vector<std::uint8_t>{1, 0, 0, 0, 1}));
  const std::vector<ClosestPoint> two = nearest(scene, {5, NumberRows(points[0].data())}, 2);
  EXPECT_EQ(two[0].prim_id, 0u);
  EXPECT_EQ(two[1].prim_id, 1u);
  EXPECT_EQ(expect_equal(scene, points), 4u);
}

TEST(Points, EqualBruteForceWhateverHappens) {
  Random random(1);
  Cube cube;
  RandomSoup soup(150, 0);
  Scene scene(Context({.threads = 2}));
  const MeshId solid = scene.add(cube.positions, cube.triangles, {.mask = 1});
  const MeshId open = scene.add_soup(soup.positions, {.mask = 2});
  Affine away;
  away.m[0][3] = 1.5f;
  away.m[1][1] = -1;  // mirrored
  const InstanceId copy = scene.instance(solid, away, 4);
  const std::vector<Point3> points = some_points(300, random);
  for (int frame = 0; frame < 6; ++frame) {
    SCOPED_TRACE(frame);
    scene.commit();
    std::size_t inside = 0;
    for (const std::uint32_t mask : {~0u, 1u, 5u, 4u, 2u}) {
      PointOptions options;
      options.mask = mask;
      inside += expect_equal(scene, points, options);
    }
    EXPECT_GT(inside, 0u);
    for (Vec3& p : cube.positions) p += random.in_box(0.1f);
    for (Vec3& p : soup.positions) p += random.in_box(0.3f);
    for (std::size_t i = 0; i < soup.positions.size(); i += 9)
      soup.positions[i] = soup.positions[i + 1];
    scene.update(solid, cube.positions);
    if (frame == 1)
      scene.replace_soup(open, std::span(soup.positions).first(300));
    else if (frame < 1)
      scene.update(open, soup.positions);
    away.m[0][3] -= 0.5f;
    scene.set_transform(copy, away);
    if (frame == 3) scene.remove(open);
  }
}

TEST(Points, PartsOfAnyStride) {
  Random random(2);
  const RandomSoup soup(60, 0);
  Scene scene;
  scene.add_soup(soup.positions);
  scene.commit();
  std::vector<Vec3> floats;
  std::vector<Point3> doubles;
  std::vector<double> columns(3 * 100), radii(100);
  for (std::size_t i = 0; i < 100; ++i) {
    const Vec3 p = random.in_box(5);
    floats.push_back(p);
    doubles.push_back({p.x, p.y, p.z});
    columns[99 - i] = p.x, columns[199 - i] = p.y, columns[299 - i] = p.z;
    radii[i] = static_cast<double>(random.unit()) * 2;
  }
  const auto expected = closest_point(scene, doubles);
  EXPECT_TRUE(same_bytes(closest_point(scene, floats), expected));
  const PointParts backwards(100, NumberRows(&columns[99], -1, 100));
  EXPECT_TRUE(same_bytes(closest_point(scene, backwards), expected));
  const PointParts same(50, NumberRows(doubles[7].data(), 0));
  for (const ClosestPoint& one : closest_point(scene, same))
    EXPECT_EQ(std::memcmp(&one, &expected[7], sizeof one), 0);
  const auto within =
      closest_point(scene, {100, NumberRows(doubles[0].data()), NumberRows(radii.data(), 1)});
  std::size_t found = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    const bool is_near = expected[i].distance <= radii[i];
    EXPECT_EQ(within[i].prim_id, is_near ? expected[i].prim_id : kInvalidId);
    EXPECT_EQ(within[i].distance, is_near ? expected[i].distance : kInfinity);
    EXPECT_EQ(std::isnan(within[i].point[0]), !is_near);
    found += is_near ? 1 : 0;
  }
  EXPECT_GT(found, 10u);
  EXPECT_LT(found, 90u);
  expect_equal(scene, {100, NumberRows(doubles[0].data()), NumberRows(radii.data(), 1)});
  // The radius itself belongs to it.
  const double exactly = expected[3].distance;
  const PointParts at(1, NumberRows(doubles[3].data()), NumberRows(&exactly, 0));
  EXPECT_EQ(closest_point(scene, at).front().prim_id, expected[3].prim_id);
}

TEST(Points, TrianglesWithoutAreaCount) {
  Scene scene;
  const std::vector<Vec3> point{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  const std::vector<Vec3> segment{{0, 0, 0}, {4, 0, 0}, {2, 0, 0}};
  scene.add_soup(point);
  scene.add_soup(segment);
  scene.commit();
  const std::vector<Point3> points{{1, 1, 3}, {3, 0.5, 0}, {9, 0, 0}};
  const auto found = closest_point(scene, points);
  EXPECT_EQ(found[0].distance, 2);
  EXPECT_EQ(found[0].geom_id, 0u);
  EXPECT_EQ(found[1].distance, 0.5);
  EXPECT_EQ(found[1].point, (Point3{3, 0, 0}));
  EXPECT_EQ(found[1].geom_id, 1u);
  EXPECT_EQ(found[1].side, 0);
  EXPECT_EQ(found[2].distance, 5);
  expect_equal(scene, points);
}

TEST(Points, NothingToBeNearTo) {
  Scene scene;
  scene.commit();
  const std::vector<Vec3> points(3);
  for (const ClosestPoint& one : nearest(scene, points, 2)) {
    EXPECT_EQ(one.prim_id, kInvalidId);
    EXPECT_EQ(one.distance, kInfinity);
  }
  EXPECT_EQ(signed_distance(scene, points), std::vector<double>(3, kInfinity));
  EXPECT_EQ(contains(scene, points), std::vector<std::uint8_t>(3, 0));
  EXPECT_TRUE(closest_point(scene, std::span<const Vec3>()).empty());
  expect_equal(scene, points);
}

TEST(Points, WhatIsWrongIsNamed) {
  const Square square;
  Scene scene;
  scene.add(square.positions, square.triangles);
  std::vector<Vec3> points(1000);
  std::vector<ClosestPoint> found(1000);
  const auto ask = [&] { closest_point(scene, points, found); };
  expect_error(ErrorCode::kWrongState, "scene", "commit", ask);
  scene.commit();
  found.resize(999);
  expect_error(ErrorCode::kInvalidArgument, "found", "999 results for 1000 points", ask);
  found.resize(1000);
  points[700].y = kNaN;
  points[900].x = kInfinity;
  expect_error(ErrorCode::kInvalidData, "points[700]", "the point is not finite", ask);
  points[600].z = -2e18f;
  expect_error(ErrorCode::kInvalidData, "points[600]", "the point is farther out than 1e18", ask);
  Scene none;
  none.commit();
  expect_error(ErrorCode::kInvalidData, "points[600]", "farther",
               [&] { static_cast<void>(contains(none, points)); });
  PointOptions unchecked;
  unchecked.check = false;
  closest_point(scene, points, found, unchecked);
  EXPECT_EQ(found[0].distance, 0);
  points.resize(500);
  std::vector<float> radii(500, 1);
  const PointParts parts(500, NumberRows(&points[0].x), NumberRows(radii.data(), 1));
  const auto ask_distances = [&] { static_cast<void>(signed_distance(scene, parts)); };
  radii[3] = -1;
  expect_error(ErrorCode::kInvalidData, "radii[3]", "the radius is negative", ask_distances);
  radii[2] = kNaN;
  expect_error(ErrorCode::kInvalidData, "radii[2]", "the radius is not a number", ask_distances);
  expect_error(ErrorCode::kInvalidArgument, "k", "k is 0",
               [&] { static_cast<void>(nearest(scene, points, 0)); });
  expect_error(ErrorCode::kInvalidArgument, "points", "no coordinates for 4 points",
               [&] { static_cast<void>(contains(scene, PointParts(4, {}))); });
  std::atomic<bool> stop{true};
  PointOptions stopped;
  stopped.stop = &stop;
  expect_error(ErrorCode::kCancelled, "", "",
               [&] { static_cast<void>(contains(scene, points, stopped)); });
}

TEST(Points, StatisticsTellWhatWasDone) {
  const Cube cube;
  Scene scene;
  const MeshId mesh = scene.add(cube.positions, cube.triangles);
  scene.commit();
  const std::vector<Vec3> points(10);
  QueryStatistics statistics;
  PointOptions options;
  options.statistics = &statistics;
  static_cast<void>(signed_distance(scene, points, options));
  EXPECT_EQ(statistics.rays, 10u);
  EXPECT_EQ(statistics.triangles, 12u);
  EXPECT_GT(statistics.total_ms, 0);
  ASSERT_FALSE(statistics.plan.empty());
  EXPECT_NE(statistics.plan.back().find("closed"), std::string::npos);
  scene.replace(mesh, cube.positions, std::span(cube.triangles).first(11));
  scene.commit();
  static_cast<void>(contains(scene, points, options));
  EXPECT_NE(statistics.plan.back().find("open"), std::string::npos);
}

/// Queries of rays and of points alternate on the same tree.
TEST(Points, RaysBetween) {
  Random random(3);
  RandomSoup soup(400, 100);
  Scene scene;
  const MeshId mesh = scene.add_soup(soup.positions);
  const std::vector<Point3> points = some_points(50, random);
  for (int frame = 0; frame < 4; ++frame) {
    scene.update(mesh, soup.positions);
    scene.commit();
    if (frame % 2 == 0) static_cast<void>(closest_hit(scene, soup.rays));
    expect_equal(scene, points);
    QueryOptions brute;
    brute.method = QueryMethod::kBrute;
    const auto hits = closest_hit(scene, soup.rays),
               expected = closest_hit(scene, soup.rays, brute);
    for (std::size_t i = 0; i < hits.size(); ++i) EXPECT_TRUE(same(hits[i], expected[i]));
    for (Vec3& p : soup.positions) p += random.in_box(0.2f);
  }
}

}  // namespace
}  // namespace raysheaf::test
