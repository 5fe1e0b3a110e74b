// Long random sequences of scene changes, compared with a brute force model.
#include "api/api_support.h"
#include "reference/scene_model.h"

namespace raysheaf::test {
namespace {

class Life {
 public:
  explicit Life(std::uint64_t seed, std::uint32_t threads)
      : random_(seed), scene_(Context({.threads = threads})) {}

  void step() {
    const std::uint32_t kind = random_.below(16);
    if (kind < 3 || model_.meshes.empty()) return add();
    if (kind < 5) return replace();
    if (kind < 9) return update();
    if (kind < 10) return remove();
    if (kind < 12) return instance();
    if (model_.instances.empty()) return;
    if (kind < 13) return remove_instance();
    if (kind < 15) return move();
    set_mask();
  }

  /// Commits, and compares every query under a few masks.
  void compare() {
    scene_.commit();
    ASSERT_EQ(scene_.triangle_count(), model_.triangle_count());
    const std::vector<Ray> rays = some_rays();
    for (const std::uint32_t mask : {0xffffffffu, random_mask(), random_mask()}) {
      for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute}) {
        const QueryOptions options{.method = method, .mask = mask};
        const std::vector<Hit> hits = closest_hit(scene_, rays, options);
        const std::vector<std::uint8_t> occluded = any_hit(scene_, rays, options);
        const HitRows rows = all_hits(scene_, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::vector<Hit> expected = model_.all_hits(rays[i], mask);
          ASSERT_TRUE(same(hits[i], expected.empty() ? Hit{} : expected[0])) << shown(hits[i]);
          ASSERT_EQ(occluded[i] != 0, !expected.empty());
          ASSERT_TRUE(std::ranges::equal(rows[i], expected, same));
        }
      }
    }
  }

 private:
  ModelMesh some_mesh() {
    ModelMesh mesh;
    mesh.positions.resize(random_.below(40));
    for (Vec3& p : mesh.positions) p = random_.in_box(2);
    const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
    if (vertices > 0) mesh.triangles.resize(random_.below(30));
    for (Triangle& t : mesh.triangles)
      for (std::uint32_t& index : t) index = random_.below(vertices);
    return mesh;
  }
  /// The mesh as a soup: the model's indices count up.
  ModelMesh some_soup() {
    ModelMesh mesh;
    mesh.positions.resize(std::size_t{3} * random_.below(12));
    for (Vec3& p : mesh.positions) p = random_.in_box(2);
    for (std::uint32_t i = 0; i < mesh.positions.size(); i += 3)
      mesh.triangles.push_back({i, i + 1, i + 2});
    return mesh;
  }
  Affine some_transform() {
    if (random_.below(4) == 0) return {};
    const Affine turned = compose(rotation(random_.direction(), random_.between(0, 6)),
                                  scaling(random_.in_box(1.5f)));  // sometimes mirrored
    return compose(translation(random_.in_box(4)), turned);
  }
  std::uint32_t random_mask() { return 1 + random_.below(7); }
  template <class Map>
  auto any_of(Map& map) {
    return std::next(map.begin(), random_.below(static_cast<std::uint32_t>(map.size())));
  }
  std::vector<Ray> some_rays() {
    std::vector<Ray> rays(24);
    for (Ray& ray : rays) {
      ray.origin = random_.in_box(6);
      ray.direction = random_.in_box(1) - ray.origin * 0.3f;
      ray.t_min = random_.between(0, 1);
      if (random_.below(3) == 0) ray.t_max = random_.between(1, 4);
    }
    return rays;
  }

  void add() {
    const bool soup = random_.below(3) == 0;
    ModelMesh mesh = soup ? some_soup() : some_mesh();
    MeshOptions options{.place = random_.below(4) != 0};
    options.transform = some_transform();
    options.mask = random_mask();
    const MeshId id = soup ? scene_.add_soup(mesh.positions, options)
                           : scene_.add(mesh.positions, mesh.triangles, options);
    model_.meshes[id] = std::move(mesh);
    if (options.place)
      model_.instances[scene_.instances(id).front()] = {id, options.transform, options.mask};
  }
  void replace() {
    auto& [id, mesh] = *any_of(model_.meshes);
    const bool soup = random_.below(3) == 0;
    mesh = soup ? some_soup() : some_mesh();
    if (soup)
      scene_.replace_soup(id, mesh.positions);
    else
      scene_.replace(id, mesh.positions, mesh.triangles);
  }
  void update() {
    auto& [id, mesh] = *any_of(model_.meshes);
    for (Vec3& p : mesh.positions) p += random_.in_box(0.5f);
    if (!mesh.positions.empty() && random_.below(4) == 0)
      // All triangles become degenerate.
      mesh.positions.assign(mesh.positions.size(), mesh.positions.front());
    scene_.update(id, mesh.positions);
  }
  void remove() {
    const MeshId id = any_of(model_.meshes)->first;
    model_.meshes.erase(id);
    std::erase_if(model_.instances, [id](const auto& entry) { return entry.second.mesh == id; });
    scene_.remove(id);
  }
  void instance() {
    const MeshId id = any_of(model_.meshes)->first;
    const Affine transform = some_transform();
    const std::uint32_t mask = random_mask();
    model_.instances[scene_.instance(id, transform, mask)] = {id, transform, mask};
  }
  void remove_instance() {
    const auto gone = any_of(model_.instances);
    scene_.remove_instance(gone->first);
    model_.instances.erase(gone);
  }
  void move() {
    auto& [id, instance] = *any_of(model_.instances);
    instance.transform = some_transform();
    scene_.set_transform(id, instance.transform);
  }
  void set_mask() {
    auto& [id, instance] = *any_of(model_.instances);
    instance.mask = random_mask();
    scene_.set_mask(id, instance.mask);
  }

  Random random_;
  Scene scene_;
  SceneModel model_;
};

TEST(Changes, AnswersAreThoseOfTheModel) {
  for (const std::uint32_t threads : {1u, 2u}) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE(seed);
      Life life(seed, threads);
      Random random(seed + 100);
      for (int commit = 0; commit < 25; ++commit) {
        for (std::uint32_t i = random.below(5); i > 0; --i) life.step();
        life.compare();
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

// Renderer and scene must transform vertices to the same bits, including the sign of zero.
TEST(Changes, MovedMeshesAreThoseThatWereMadeThere) {
  const Square square(-0.0f);
  Scene moved, made;
  const Affine transform = compose(translation({0.1f, 0.2f, 3}), rotation({0, 0, 1}, 0.3f));
  moved.add(square.positions, square.triangles, {.transform = transform});
  std::vector<Vec3> positions;
  for (const Vec3 p : square.positions) positions.push_back(transform_point(transform, p));
  made.add(positions, square.triangles);
  moved.commit();
  made.commit();
  for (float x = -0.9f; x < 0.9f; x += 0.17f)
    EXPECT_TRUE(same(first_hit(moved, along_z(x)), first_hit(made, along_z(x))));
}

TEST(Changes, AThousandFramesKeepTheirMemory) {
  Scene scene;
  Square square;
  const MeshId moving = scene.add(square.positions, square.triangles);
  const MeshId changing = scene.add(square.positions, square.triangles, {.mask = 2});
  const InstanceId turning = scene.instance(moving, Affine{});
  std::size_t bytes = 0;
  for (int frame = 0; frame < 1000; ++frame) {
    const auto z = static_cast<float>(frame % 7);
    for (Vec3& p : square.positions) p.z = z;
    scene.update(moving, square.positions);
    scene.replace(changing, Square(z + 1).positions, square.triangles);
    scene.set_transform(turning, translation({0, 0, z + 20}));
    scene.remove(scene.add(square.positions, square.triangles));
    const MeshId passing = scene.add(square.positions, square.triangles, {.mask = 4});
    scene.commit();
    EXPECT_EQ(first_hit(scene, along_z()).t, 10 + z);
    EXPECT_EQ(first_hit(scene, along_z(), {.mask = 2}).t, 10 + z);
    EXPECT_EQ(first_hit(scene, along_z(), {.mask = 4}).geom_id, moving);
    scene.remove(passing);
    if (frame == 20) bytes = scene.memory_bytes();
  }
  EXPECT_EQ(scene.memory_bytes(), bytes);
}

}  // namespace
}  // namespace raysheaf::test
