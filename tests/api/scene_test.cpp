// Scenes: ids, counts, bounds, and refused arguments.
#include "raysheaf/scene.h"

#include "api/api_support.h"

namespace raysheaf::test {
namespace {

TEST(Context, SaysWhereItIs) {
  const Context one(ContextOptions{.threads = 1});
  EXPECT_EQ(one.threads(), 1u);
  EXPECT_EQ(one.device(), Device::kCpu);
  EXPECT_STREQ(to_string(one.device()), "cpu");
  EXPECT_GE(Context().threads(), 1u);
  const Scene scene(one);
  EXPECT_EQ(scene.context().threads(), 1u);
}

TEST(Context, RefusesWhatItCannotDo) {
  expect_error(ErrorCode::kInvalidArgument, "threads", "1025",
               [] { Context(ContextOptions{.threads = 1025}); });
  expect_error(ErrorCode::kInvalidArgument, "device", "not a valid device",
               [] { Context(ContextOptions{.device = static_cast<Device>(7)}); });
}

TEST(Scene, CountsWhatIsInIt) {
  Scene scene;
  const Square square;
  const MeshId a = scene.add(square.positions, square.triangles);
  const MeshId b = scene.add_soup(std::vector<Vec3>(6), {.place = false});
  EXPECT_EQ(scene.mesh_count(), 2u);
  EXPECT_EQ(scene.instance_count(), 1u);
  EXPECT_EQ(scene.triangle_count(), 2u);
  const InstanceId second = scene.instance(b, Affine{}, 5);
  scene.instance(b, Affine{});
  EXPECT_EQ(scene.triangle_count(), 6u);
  EXPECT_EQ(scene.vertex_count(b), 6u);
  EXPECT_EQ(scene.triangle_count(b), 2u);
  EXPECT_EQ(scene.mask(second), 5u);
  EXPECT_EQ(scene.mesh_of(second), b);
  EXPECT_EQ(scene.meshes(), (std::vector<MeshId>{a, b}));
  EXPECT_EQ(scene.instances(b), (std::vector<InstanceId>{1, 2}));
  EXPECT_GT(scene.memory_bytes(), 6 * sizeof(Vec3));
}

TEST(Scene, NeverUsesAnIdAgain) {
  Scene scene;
  const Square square;
  const MeshId a = scene.add(square.positions, square.triangles);
  const InstanceId first = scene.instances(a).front();
  scene.remove(a);
  EXPECT_FALSE(scene.has_mesh(a));
  EXPECT_FALSE(scene.has_instance(first));
  const MeshId b = scene.add(square.positions, square.triangles);
  EXPECT_GT(b, a);
  EXPECT_GT(scene.instances(b).front(), first);
  scene.commit();
  const Hit hit = first_hit(scene, along_z());
  EXPECT_EQ(hit.geom_id, b);
  EXPECT_EQ(hit.inst_id, scene.instances(b).front());
}

TEST(Scene, KeepsTransformsAsGiven) {
  Scene scene;
  const Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles);
  const Affine moved = translation({1, 2, 3});
  const InstanceId instance = scene.instance(mesh, moved);
  EXPECT_EQ(scene.transform(instance).m, moved.m);
  scene.set_transform(instance, scaling({2, 2, 2}));
  EXPECT_EQ(scene.transform(instance).m, scaling({2, 2, 2}).m);
}

TEST(Scene, BoundsAllInstances) {
  Scene scene;
  scene.commit();
  EXPECT_GT(scene.bounds().min.x, scene.bounds().max.x);
  const Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles);
  scene.instance(mesh, translation({10, 0, 5}), 0);
  scene.commit();
  EXPECT_EQ(scene.bounds().min, (Vec3{-1, -1, 0}));
  EXPECT_EQ(scene.bounds().max, (Vec3{11, 1, 5}));
  scene.remove(mesh);
  scene.commit();
  EXPECT_GT(scene.bounds().min.x, scene.bounds().max.x);
}

TEST(Scene, MovesButDoesNotCopy) {
  static_assert(!std::is_copy_constructible_v<Scene> && !std::is_copy_assignable_v<Scene>);
  Scene scene;
  const Square square;
  scene.add(square.positions, square.triangles);
  scene.commit();
  Scene other = std::move(scene);
  EXPECT_EQ(first_hit(other, along_z()).t, 10);
  expect_error(ErrorCode::kWrongState, "scene", "moved from",
               [&] { scene.commit(); });  // NOLINT(bugprone-use-after-move)
  scene = std::move(other);
  EXPECT_EQ(first_hit(scene, along_z()).t, 10);
}

TEST(Scene, SharesArraysOnRequest) {
  Scene scene;
  Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles, {.storage = Storage::kShare});
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z()).t, 10);
  for (Vec3& p : square.positions) p.z = 5;
  scene.update(mesh, square.positions);
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z()).t, 15);
  const Square other(7);
  scene.replace(mesh, other.positions, other.triangles);
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z()).t, 17);
}

TEST(Scene, TakesCopiesOtherwise) {
  Scene scene;
  Square square;
  scene.add(square.positions, square.triangles);
  square.positions.assign(4, {});
  square.triangles.assign(2, {});
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z()).t, 10);
}

struct Refusal {
  const char* name;
  ErrorCode code;
  const char* place;
  const char* words;
  std::function<void(Scene&)> call;
};

std::vector<Vec3> with(std::size_t i, Vec3 wrong) {
  std::vector<Vec3> positions = Square().positions;
  positions[i] = wrong;
  return positions;
}

Affine not_finite() {
  Affine a;
  a.m[2][3] = kNaN;
  return a;
}

// Each call gets a new scene: mesh 0 is a square with instance 0; mesh 1 and instance 1 were
// removed.
std::vector<Refusal> refusals() {
  const Square square;
  const std::vector<Triangle> triangles = square.triangles;
  const auto data = ErrorCode::kInvalidData;
  const auto argument = ErrorCode::kInvalidArgument;
  const auto missing = ErrorCode::kNotFound;
  return {
      {"add NaN", data, "meshes[2].positions[1]", "not finite",
       [=](Scene& s) {
         s.add(with(1, {0, kNaN, 0}), triangles);
       }},
      {"add infinity", data, "meshes[2].positions[3]", "not finite",
       [=](Scene& s) {
         s.add(with(3, {0, 0, -kInfinity}), triangles);
       }},
      {"add far", data, "meshes[2].positions[0]", "1e18",
       [=](Scene& s) {
         s.add(with(0, {2e18f, 0, 0}), triangles);
       }},
      {"add shared NaN", data, "meshes[2].positions[2]", "not finite",
       [=](Scene& s) {
         s.add(with(2, {kNaN, 0, 0}), triangles, {.storage = Storage::kShare});
       }},
      {"add bad index", data, "meshes[2].triangles[1]", "index 2 is 4, but the mesh has 4 vertices",
       [=](Scene& s) {
         s.add(square.positions, std::vector<Triangle>{{0, 1, 2}, {0, 1, 4}});
       }},
      {"add index without vertices", data, "meshes[2].triangles[0]", "0 vertices",
       [=](Scene& s) {
         s.add({}, std::vector<Triangle>{{0, 0, 0}});
       }},
      {"add soup of four", argument, "meshes[2].positions", "multiple of three",
       [=](Scene& s) { s.add_soup(square.positions); }},
      {"add with bad transform", argument, "meshes[2].transform", "not finite",
       [=](Scene& s) { s.add(square.positions, triangles, {.transform = not_finite()}); }},
      {"update with fewer", argument, "meshes[0].positions",
       "3 vertices are given, but the mesh "
       "has 4",
       [=](Scene& s) { s.update(0, std::vector<Vec3>(3)); }},
      {"update NaN", data, "meshes[0].positions[0]", "not finite",
       [=](Scene& s) {
         s.update(0, with(0, {0, 0, kNaN}));
       }},
      {"update removed", missing, "meshes[1]", "was removed",
       [=](Scene& s) { s.update(1, square.positions); }},
      {"update unknown", missing, "meshes[9]", "no such mesh",
       [=](Scene& s) { s.update(9, square.positions); }},
      {"replace removed", missing, "meshes[1]", "was removed",
       [=](Scene& s) { s.replace(1, square.positions, triangles); }},
      {"replace bad index", data, "meshes[0].triangles[0]", "index 0 is 7",
       [=](Scene& s) {
         s.replace(0, square.positions, std::vector<Triangle>{{7, 0, 0}});
       }},
      {"replace NaN", data, "meshes[0].positions[2]", "not finite",
       [=](Scene& s) {
         s.replace(0, with(2, {kNaN, 0, 0}), triangles);
       }},
      {"remove twice", missing, "meshes[1]", "was removed", [](Scene& s) { s.remove(1); }},
      {"remove kInvalidId", missing, "meshes[4294967295]", "no such mesh",
       [](Scene& s) { s.remove(kInvalidId); }},
      {"instance of removed", missing, "meshes[1]", "was removed",
       [](Scene& s) { s.instance(1, Affine{}); }},
      {"instance NaN", argument, "instances[2].transform", "not finite",
       [](Scene& s) { s.instance(0, not_finite()); }},
      {"remove removed instance", missing, "instances[1]", "was removed",
       [](Scene& s) { s.remove_instance(1); }},
      {"transform unknown", missing, "instances[5]", "no such instance",
       [](Scene& s) { s.set_transform(5, Affine{}); }},
      {"transform NaN", argument, "instances[0].transform", "not finite",
       [](Scene& s) { s.set_transform(0, not_finite()); }},
      {"mask unknown", missing, "instances[5]", "no such instance",
       [](Scene& s) { s.set_mask(5, 1); }},
      {"look at removed mesh", missing, "meshes[1]", "was removed",
       [](Scene& s) { (void)s.instances(1); }},
      {"look at removed instance", missing, "instances[1]", "was removed",
       [](Scene& s) { (void)s.transform(1); }},
  };
}

TEST(Scene, RefusalsNameThePlaceAndChangeNothing) {
  for (const Refusal& refusal : refusals()) {
    SCOPED_TRACE(refusal.name);
    Scene scene;
    const Square square;
    scene.add(square.positions, square.triangles);
    scene.remove(scene.add(square.positions, square.triangles));
    scene.commit();
    expect_error(refusal.code, refusal.place, refusal.words, [&] { refusal.call(scene); });
    EXPECT_TRUE(scene.is_committed());
    EXPECT_EQ(scene.mesh_count(), 1u);
    EXPECT_EQ(scene.instance_count(), 1u);
    EXPECT_EQ(first_hit(scene, along_z()).t, 10);
    EXPECT_EQ(scene.add({}, {}), 2u);
  }
}

/// A square whose triangles use vertices 1 to 4; other vertices are unused.
struct SquareAmongOthers {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles{{1, 2, 3}, {1, 3, 4}};

  explicit SquareAmongOthers(float z = 0) : positions(Square(z).positions) {
    positions.insert(positions.begin(), {kNaN, 0, 0});
    positions.insert(positions.end(), {{0, kInfinity, 0}, {0, 0, 2e18f}, {1e18f, 0, 0}});
  }
};

TEST(Scene, VerticesThatNoTriangleUsesMayBeAnything) {
  for (const Storage storage : {Storage::kCopy, Storage::kShare}) {
    SCOPED_TRACE(storage == Storage::kShare ? "shared" : "copied");
    const SquareAmongOthers first, moved(1), replaced(2);
    std::vector<Vec3> wrong = SquareAmongOthers().positions;
    wrong[4].x = kNaN;
    Scene scene(Context({.threads = 2}));
    const auto expect_hits = [&](float t) {
      scene.commit();
      EXPECT_EQ(first_hit(scene, along_z()).t, t);
      EXPECT_EQ(scene.bounds().max.z, 2 * (t - 10));
    };
    const MeshId mesh = scene.add(first.positions, first.triangles, {.storage = storage});
    scene.instance(mesh, scaling({2, 2, 2}));
    expect_hits(10);
    scene.update(mesh, moved.positions);
    expect_hits(11);
    expect_error(ErrorCode::kInvalidData, "meshes[0].positions[4]", "not finite",
                 [&] { scene.update(mesh, wrong); });
    expect_error(ErrorCode::kInvalidData, "meshes[0].positions[4]", "not finite",
                 [&] { scene.replace(mesh, wrong, first.triangles); });
    expect_error(ErrorCode::kInvalidData, "meshes[0].triangles[1]", "index 2 is 8", [&] {
      scene.replace(mesh, first.positions, std::vector<Triangle>{{1, 2, 3}, {1, 3, 8}});
    });
    scene.replace(mesh, replaced.positions, replaced.triangles);
    expect_hits(12);
    const InstanceId far = scene.instance(mesh, scaling({2e18f, 1, 1}));
    expect_error(ErrorCode::kInvalidData, "instances[2].transform", "1e18",
                 [&] { scene.commit(); });
    scene.remove_instance(far);
    expect_hits(12);
  }
}

TEST(Scene, RefusesTransformsThatLeaveTheWorldAtCommit) {
  Scene scene;
  const Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles);
  const InstanceId far = scene.instance(mesh, scaling({1e30f, 1, 1}));
  for (int again = 0; again < 2; ++again)
    expect_error(ErrorCode::kInvalidData, "instances[1].transform", "1e18",
                 [&] { scene.commit(); });
  EXPECT_FALSE(scene.is_committed());
  scene.set_transform(far, scaling({1, 0, 0}));  // flat, which is allowed
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z()).t, 10);
}

TEST(Scene, CommitsWithoutAnything) {
  Scene scene;
  EXPECT_FALSE(scene.is_committed());
  scene.commit();
  scene.commit();
  EXPECT_TRUE(scene.is_committed());
  EXPECT_EQ(first_hit(scene, along_z()).prim_id, kInvalidId);
  scene.add({}, {});
  scene.add_soup({});
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z()).prim_id, kInvalidId);
}

}  // namespace
}  // namespace raysheaf::test
