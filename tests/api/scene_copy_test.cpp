// Copies of scenes: the same ids and answers, and nothing shared.
#include "api/api_support.h"
#include "raysheaf/scene.h"

namespace raysheaf::test {
namespace {

/// Meshes with indices and without, gaps in the ids, instances with masks and transforms.
Scene varied_scene() {
  Scene scene;
  const Square square;
  scene.remove(scene.add(square.positions, square.triangles));
  const MeshId mesh = scene.add(square.positions, square.triangles, {.place = false});
  const RandomSoup soup(50, 0);
  scene.add_soup(soup.positions, {.mask = 6});
  scene.remove_instance(scene.instance(mesh, Affine{}));
  scene.instance(mesh, translation({0, 0, 3}), 3, 7);
  scene.add(std::vector<Vec3>{}, std::vector<Triangle>{});
  scene.remove_instance(scene.instance(mesh, Affine{}));
  scene.remove(scene.add_soup(std::vector<Vec3>(3)));
  scene.commit();
  return scene;
}

void expect_same_scene(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.meshes(), b.meshes());
  EXPECT_EQ(a.next_mesh(), b.next_mesh());
  EXPECT_EQ(a.next_instance(), b.next_instance());
  for (const MeshId mesh : a.meshes()) {
    EXPECT_EQ(a.instances(mesh), b.instances(mesh));
    EXPECT_EQ(a.is_soup(mesh), b.is_soup(mesh));
    EXPECT_TRUE(std::ranges::equal(a.triangles(mesh), b.triangles(mesh)));
    EXPECT_EQ(a.vertex_count(mesh), b.vertex_count(mesh));
    for (const InstanceId instance : a.instances(mesh)) {
      EXPECT_EQ(a.mask(instance), b.mask(instance));
      EXPECT_EQ(a.world(instance), b.world(instance));
      EXPECT_EQ(a.transform(instance).m, b.transform(instance).m);
    }
  }
  const RandomSoup soup(0, 500);
  for (const std::uint32_t mask : {0xffffffffu, 1u, 4u}) {
    const std::vector<Hit> hits = closest_hit(a, soup.rays, {.mask = mask});
    const std::vector<Hit> again = closest_hit(b, soup.rays, {.mask = mask});
    for (std::size_t i = 0; i < hits.size(); ++i) EXPECT_TRUE(same(hits[i], again[i]));
  }
}

TEST(SceneCopy, HasTheSameIdsAndAnswers) {
  const Scene scene = varied_scene();
  const Scene copy = scene.copy();
  expect_same_scene(scene, copy);
  expect_same_scene(scene, copy.copy());
}

TEST(SceneCopy, SharesNothing) {
  Scene scene;
  const Square square;
  std::vector<Vec3> positions = Square(1).positions;
  const MeshId mesh = scene.add(positions, square.triangles, {.storage = Storage::kShare});
  scene.commit();
  Scene copy = scene.copy();
  for (Vec3& p : positions) p.z = 2;
  EXPECT_EQ(first_hit(copy, along_z()).t, 11);
  copy.update(mesh, Square(5).positions);
  copy.commit();
  EXPECT_EQ(first_hit(copy, along_z()).t, 15);
  EXPECT_EQ(scene.positions(mesh).front().z, 2);
}

TEST(SceneCopy, ChangesThatWaitWaitThere) {
  Scene scene;
  const Square square;
  scene.add(square.positions, square.triangles);
  Scene copy = scene.copy();
  EXPECT_FALSE(copy.is_committed());
  copy.commit();
  EXPECT_FALSE(scene.is_committed());
  EXPECT_EQ(first_hit(copy, along_z()).geom_id, 0u);
}

TEST(SceneCopy, IdsAreNotGivenOutAgain) {
  Scene scene;
  scene.continue_ids(3, 7);
  const Square square;
  EXPECT_EQ(scene.add(square.positions, square.triangles), 3u);
  EXPECT_EQ(scene.instances(3), (std::vector<InstanceId>{7}));
  expect_error(ErrorCode::kInvalidArgument, "scene", "given out",
               [&] { scene.continue_ids(3, 8); });
  expect_error(ErrorCode::kInvalidArgument, "scene", "given out",
               [&] { scene.continue_ids(4, 7); });
  expect_error(ErrorCode::kNotFound, "meshes[2]", "removed", [&] { scene.remove(2); });
}

}  // namespace
}  // namespace raysheaf::test
