// Answers about rays and points: the same bits on every machine, at every SIMD width.
#include <gtest/gtest.h>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/hit_points.h"
#include "raysheaf/lab.h"
#include "raysheaf/points.h"
#include "raysheaf/query.h"
#include "support/simd_targets.h"
#include "support/soups.h"
#include "tests/bits/checksums.h"

namespace raysheaf::test {
namespace {

Scene scene_of(const SceneDescription& description) {
  Scene scene;
  for (const Instance& instance : description.instances) {
    const Mesh& mesh = description.meshes[instance.mesh];
    MeshOptions options;
    options.transform = instance.to_world;
    scene.add(mesh.positions, mesh.triangles, options);
  }
  scene.commit();
  return scene;
}

void add_rows(Checksum* sum, const HitRows& rows) {
  sum->add(std::span<const std::uint64_t>(rows.offsets));
  sum->add(std::span<const Hit>(rows.hits));
}

Checksum answers(const Scene& scene, const std::vector<Ray>& rays) {
  Checksum sum;
  QueryOptions options;
  for (const Sides sides : {Sides::kBoth, Sides::kFront, Sides::kBack}) {
    options.sides = sides;
    sum.add(closest_hit(scene, rays, options));
    sum.add(any_hit(scene, rays, options));
    sum.add(hit_counts(scene, rays, options));
    add_rows(&sum, all_hits(scene, rays, options));
  }
  const std::vector<Hit> hits = closest_hit(scene, rays);
  for (const HitPoint& point : hit_points(scene, rays, hits))
    sum.add_all(point.position, point.normal, point.clearance, point.vertices, point.front);
  return sum;
}

class RaysInSoups : public testing::TestWithParam<SoupKind> {};

TEST_P(RaysInSoups, AreTheSameEverywhere) {
  const auto number = static_cast<std::uint64_t>(GetParam());
  const SceneDescription description = soup(GetParam(), 300, number);
  const Scene scene = scene_of(description);
  const std::vector<Ray> rays = rays_at(description, 1500, number + 100);
  const std::string name = "rays in soup " + std::to_string(number);
  for_each_simd_target([&](const char*) { expect_bits(name, answers(scene, rays)); });
  QueryOptions brute;
  brute.method = QueryMethod::kBrute;
  expect_bits("closest hits in soup " + std::to_string(number),
              checksum_of(closest_hit(scene, rays, brute)));
}

INSTANTIATE_TEST_SUITE_P(Bits, RaysInSoups, testing::ValuesIn(soup_kinds()));

class RaysInScenes : public testing::TestWithParam<const char*> {};

TEST_P(RaysInScenes, AreTheSameEverywhere) {
  const SceneDescription description = builtin_scene(GetParam());
  const Scene scene = scene_of(description);
  Laboratory laboratory(description, 64, 48, 1);
  int number = 0;
  for (const LabRays kind : {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2,
                             LabRays::kAmbientOcclusion}) {
    const std::vector<Ray> rays = laboratory.rays(kind);
    const std::string name = std::string(GetParam()) + ", batch " + std::to_string(number++) + ": ";
    expect_bits(name + "rays", checksum_of(rays));
    for_each_simd_target([&](const char*) {
      expect_bits(name + "closest hits", checksum_of(closest_hit(scene, rays)));
      expect_bits(name + "any hits", checksum_of(any_hit(scene, rays)));
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Bits, RaysInScenes, testing::Values("office", "cornell", "atrium"),
                         [](const auto& test) { return std::string(test.param); });

TEST(RaysAndMovingMeshes, AreTheSameEverywhere) {
  SceneDescription description = soup(SoupKind::kSmall, 2000, 7);
  std::vector<Vec3>& positions = description.meshes[0].positions;
  Scene scene;
  const MeshId mesh = scene.add(positions, description.meshes[0].triangles);
  const std::vector<Ray> rays = rays_at(description, 3000, 8);
  Random random(9);
  Checksum sum;
  for (int frame = 0; frame < 4; ++frame) {
    for (Vec3& p : positions) p = p + random.in_box(0.3f);
    scene.update(mesh, positions);
    scene.commit();
    sum.add(closest_hit(scene, rays));
  }
  expect_bits("moving mesh", sum);
}

void add_points(Checksum* sum, const std::vector<ClosestPoint>& found) {
  for (const ClosestPoint& p : found)
    sum->add_all(p.distance, p.point, p.u, p.v, p.prim_id, p.geom_id, p.inst_id, p.side);
}

class PointsInSoups : public testing::TestWithParam<SoupKind> {};

TEST_P(PointsInSoups, AreTheSameEverywhere) {
  const auto number = static_cast<std::uint64_t>(GetParam());
  const SceneDescription description = soup(GetParam(), 200, number + 20);
  const Scene scene = scene_of(description);
  std::vector<std::array<double, 3>> points;
  for (const Ray& ray : rays_at(description, 400, number + 200)) {
    const Vec3 p = ray.origin + ray.direction;
    points.push_back({p.x, p.y, p.z});
    points.push_back({p.x / 3.0, p.y / 7.0, p.z / 11.0});
  }
  for_each_simd_target([&](const char*) {
    Checksum sum;
    add_points(&sum, closest_point(scene, points));
    add_points(&sum, nearest(scene, points, 3));
    PointOptions options;
    for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd}) {
      options.inside = rule;
      sum.add(signed_distance(scene, points, options));
      sum.add(contains(scene, points, options));
    }
    expect_bits("points in soup " + std::to_string(number), sum);
  });
}

INSTANTIATE_TEST_SUITE_P(Bits, PointsInSoups, testing::ValuesIn(soup_kinds()));

}  // namespace
}  // namespace raysheaf::test
