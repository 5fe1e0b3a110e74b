// Positions, normals and sides of hits.
#include "raysheaf/hit_points.h"

#include "api/api_support.h"
#include "raysheaf/exact.h"

namespace raysheaf::test {
namespace {

constexpr Affine kMirror{{{{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};

Scene soup_scene(const RandomSoup& soup) {
  Scene scene;
  const MeshId mesh = scene.add_soup(soup.positions);
  scene.instance(mesh, kMirror);
  scene.instance(mesh, translation({1, 2, 3}));
  scene.commit();
  return scene;
}

std::array<Vec3, 3> corners_in_world(const Scene& scene, const Hit& hit) {
  std::array<Vec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k)
    corners[k] = transform_point(scene.transform(hit.inst_id),
                                 scene.positions(hit.geom_id)[3 * hit.prim_id + k]);
  return corners;
}

TEST(HitPoints, TellTheExactSide) {
  const RandomSoup soup(300, 3000);
  const Scene scene = soup_scene(soup);
  const std::vector<Hit> hits = closest_hit(scene, soup.rays);
  const std::vector<HitPoint> points = hit_points(scene, soup.rays, hits);
  std::size_t fronts = 0, met = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].prim_id == kInvalidId) continue;
    const auto [a, b, c] = corners_in_world(scene, hits[i]);
    const bool mirrored = scene.transform(hits[i].inst_id).m == kMirror.m;
    const ExactAnswer exact = exact_answer(soup.rays[i], a, b, c);
    EXPECT_EQ(points[i].front, exact.front != mirrored) << i;
    // The normal points to the front, which the ray comes from or does not.
    const float along = dot(points[i].normal, soup.rays[i].direction);
    if (std::fabs(along) > 1e-3f) {
      EXPECT_EQ(points[i].front, along < 0);
    }
    fronts += points[i].front ? 1 : 0;
    ++met;
  }
  EXPECT_GT(fronts, met / 4);
  EXPECT_LT(fronts, 3 * met / 4);
}

TEST(HitPoints, TellTheExactSideOfGrazingRays) {
  // The ray runs a few ulps above or below the plane; the determinant in doubles cannot tell.
  const Vec3 a{0, 0, 0}, b{1, 1.0f / 3, 0.1f}, c{0.7f, -0.3f, 1.0f / 7};
  Random random(2);
  Scene scene;
  scene.add_soup(std::vector<Vec3>{a, b, c});
  scene.commit();
  std::size_t met = 0;
  for (int i = 0; i < 2000; ++i) {
    const float s = random.in_box(1).x, t = random.in_box(1).y;
    const Vec3 along = b * s + c * t;  // in the plane, as rounded
    const Ray ray{b * 0.3f + c * 0.3f - along, 0, along, kInfinity};
    const Hit hit = first_hit(scene, ray);
    if (hit.prim_id == kInvalidId) continue;
    ++met;
    const std::vector<HitPoint> points = hit_points(scene, std::span(&ray, 1), std::span(&hit, 1));
    EXPECT_EQ(points[0].front, exact_answer(ray, a, b, c).front);
  }
  EXPECT_GT(met, 10u);
}

TEST(HitPoints, LieOnTheTriangle) {
  const RandomSoup soup(300, 1000);
  const Scene scene = soup_scene(soup);
  const std::vector<Hit> hits = closest_hit(scene, soup.rays);
  const std::vector<HitPoint> points = hit_points(scene, soup.rays, hits);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].prim_id == kInvalidId) {
      EXPECT_TRUE(std::isnan(points[i].position.x) && std::isnan(points[i].normal.z));
      EXPECT_EQ(points[i].vertices[0], kInvalidId);
      EXPECT_FALSE(points[i].front);
      continue;
    }
    const Vec3 there = soup.rays[i].origin + soup.rays[i].direction * hits[i].t;
    EXPECT_LT(length(points[i].position - there), 1e-4f);
    EXPECT_NEAR(length(points[i].normal), 1, 1e-6f);
    EXPECT_EQ(points[i].vertices[1], 3 * hits[i].prim_id + 1);
    EXPECT_LT(points[i].clearance, 1e-4f);
  }
}

TEST(HitPoints, NormalsFaceTheRays) {
  const RandomSoup soup(300, 1000);
  const Scene scene = soup_scene(soup);
  const std::vector<Hit> hits = closest_hit(scene, soup.rays);
  const std::vector<HitPoint> points = hit_points(scene, soup.rays, hits);
  const NumberRows directions(&soup.rays[0].direction.x, sizeof(Ray) / sizeof(float));
  std::vector<Vec3> normals(hits.size());
  facing_normals(scene, directions, hits, normals);
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].prim_id == kInvalidId)
      EXPECT_TRUE(std::isnan(normals[i].x));
    else
      EXPECT_EQ(normals[i], points[i].front ? points[i].normal : -points[i].normal);
  normals.pop_back();
  expect_error(ErrorCode::kInvalidArgument, "normals", "999 normals for 1000 hits",
               [&] { facing_normals(scene, directions, hits, normals); });
}

TEST(HitPoints, RaysThatLeaveDoNotMeetTheirSurface) {
  const RandomSoup soup(200, 2000);
  Scene scene;
  const MeshId mesh = scene.add_soup(soup.positions);
  for (Affine far : {translation({1e4f, -3e3f, 20}), translation({0.1f, 100, -1e5f})})
    scene.instance(mesh, far);
  scene.commit();
  std::vector<Ray> rays = soup.rays;
  for (std::size_t i = 0; i < rays.size(); i += 2)
    rays[i].origin = rays[i].origin + Vec3{1e4f, -3e3f, 20};
  const std::vector<Hit> hits = closest_hit(scene, rays);
  const std::vector<HitPoint> points = hit_points(scene, rays, hits);
  Random random(8);
  std::vector<Ray> leaving;
  std::vector<Hit> from;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].prim_id == kInvalidId) continue;
    const Vec3 direction = random.direction();
    leaving.push_back({off_surface(points[i], direction), 0, direction, kInfinity});
    from.push_back(hits[i]);
  }
  ASSERT_GT(from.size(), 300u);
  const HitRows rows = all_hits(scene, leaving);
  for (std::size_t i = 0; i < from.size(); ++i)
    for (const Hit& hit : rows[i])
      EXPECT_FALSE(hit.prim_id == from[i].prim_id && hit.inst_id == from[i].inst_id) << hit.t;
}

TEST(HitPoints, RefuseWhatTheSceneDoesNotHave) {
  Scene scene;
  const Square square;
  scene.add(square.positions, square.triangles);
  scene.commit();
  const std::vector<Ray> rays{along_z(), along_z()};
  std::vector<Hit> hits(2);
  hits[1] = {1, 0, 0, 7, 0, 0};
  std::vector<HitPoint> points(2);
  expect_error(ErrorCode::kNotFound, "hits[1]", "no triangle 7 of instance 0",
               [&] { hit_points(scene, rays, hits, points); });
  hits[1] = {1, 0, 0, 0, 0, 3};
  expect_error(ErrorCode::kNotFound, "hits[1]", "of instance 3",
               [&] { hit_points(scene, rays, hits, points); });
  points.resize(1);
  expect_error(ErrorCode::kInvalidArgument, "points", "1 points for 2 hits",
               [&] { hit_points(scene, rays, hits, points); });
  expect_error(ErrorCode::kInvalidArgument, "rays", "2 rays for 1 hits",
               [&] { hit_points(scene, rays, std::span(hits).first(1), points); });
  points.resize(2);
  scene.remove(0);
  expect_error(ErrorCode::kWrongState, "scene", "commit",
               [&] { hit_points(scene, rays, hits, std::span(points)); });
}

}  // namespace
}  // namespace raysheaf::test
