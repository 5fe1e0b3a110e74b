// Frames whose rays enter instances where they stand: the bits of frames of placed triangles, for
// all that a surface has and however instances move, and scenes too large to be placed.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "raysheaf/error.h"
#include "raysheaf/renderer.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

bool plan_says(const RenderResult& result, const std::string& words) {
  for (const BatchStatistics& batch : result.statistics.batches)
    for (const std::string& sentence : batch.plan)
      if (sentence.find(words) != std::string::npos) return true;
  return false;
}

bool is_entered(const RenderResult& result) {
  return plan_says(result, "entered by the rays");
}

/// Counting the tests of pixels needs placed triangles.
RenderResult placed(const SceneDescription& scene, RenderOptions options) {
  options.count_pixel_tests = true;
  const RenderResult result = render(scene, options);
  EXPECT_FALSE(is_entered(result));
  return result;
}

void expect_same(const RenderResult& a, const RenderResult& b) {
  EXPECT_TRUE(test::same_bits(a.beauty, b.beauty));
  EXPECT_TRUE(test::same_bits(a.position, b.position));
  EXPECT_TRUE(test::same_bits(a.normal, b.normal));
  EXPECT_TRUE(test::same_bits(a.albedo, b.albedo));
  EXPECT_TRUE(test::same_bits(a.specular, b.specular));
  EXPECT_EQ(a.shadow, b.shadow);
  ASSERT_EQ(a.ids.size(), b.ids.size());
  for (std::size_t i = 0; i < a.ids.size(); ++i) {
    EXPECT_EQ(a.ids[i].inst_id, b.ids[i].inst_id);
    EXPECT_EQ(a.ids[i].geom_id, b.ids[i].geom_id);
    EXPECT_EQ(a.ids[i].prim_id, b.ids[i].prim_id);
  }
}

/// Turned, stretched, mirrored now and then, and put somewhere.
Affine anywhere(std::mt19937* random, float spread) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto next = [&] { return unit(*random); };
  const float size = 0.4f + 0.2f * next();
  Affine at = rotation(normalized({next(), next(), next()}, {0, 1, 0}), 3 * next());
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t c = 0; c < 3; ++c) at.m[row][c] = size * (at.m[row][c] + 0.1f * next());
  if ((*random)() % 3 == 0)
    for (auto& row : at.m) row[0] = -row[0];
  at.m[0][3] = spread * next();
  at.m[1][3] = 0.8f + 0.8f * next();
  at.m[2][3] = spread * next();
  return at;
}

/// Spheres of several materials over a floor: matte, mirror, glass, single-sided halves, textured
/// with holes, with colours and alphas of vertices.
SceneDescription spheres(std::uint32_t instances, std::uint32_t seed) {
  std::mt19937 random(seed);
  SceneDescription scene;
  test::add_mesh(&scene, test::floor_square(8, 0));
  test::add_curtain(&scene, -3, 2);
  Material matte, mirror, glass, single, holes = scene.materials[0];
  matte.base_color = {0.8f, 0.5f, 0.3f, 1};
  mirror.metallic = 1;
  mirror.roughness = 0;
  glass.transmission = 1;
  glass.roughness = 0;
  glass.double_sided = true;
  single.double_sided = false;
  for (const Material& material : {matte, mirror, glass, single})
    scene.materials.push_back(material);
  const auto first = static_cast<std::uint32_t>(scene.meshes.size());
  for (std::uint32_t material = 0; material < scene.materials.size(); ++material) {
    Mesh mesh = test::ball(20, 1);
    if (material == 0)
      for (const Vec3 n : mesh.normals) mesh.uvs.push_back({n.x, n.y});
    if (material == 1)
      for (const Vec3 n : mesh.normals) mesh.colors.push_back(abs(n));
    if (material % 2 == 1) mesh.normals.clear();
    if (material == 4) {  // half a sphere shows its inside, unless the material hides it
      mesh.triangles.resize(mesh.triangles.size() / 2);
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        mesh.materials.push_back(i % 2 == 0 ? 4 : 2);
    } else {
      mesh.materials = {material};
    }
    scene.meshes.push_back(std::move(mesh));
  }
  for (std::uint32_t i = 0; i < instances; ++i) {
    Instance instance;
    instance.mesh = first + i % static_cast<std::uint32_t>(scene.materials.size());
    instance.to_world = anywhere(&random, 4);
    scene.instances.push_back(instance);
  }
  scene.lights.push_back(test::point_light({2, 6, 3}, 100));
  Light sun;
  sun.type = Light::Type::kDirectional;
  sun.direction = normalized(Vec3{-1, -2, -0.5f}, {0, -1, 0});
  scene.lights.push_back(sun);
  scene.cameras.push_back(test::camera_at({0, 3, 8}, {0, 0.8f, 0}));
  return scene;
}

TEST(Entered, FramesHaveTheBitsOfPlacedTriangles) {
  const SceneDescription scene = spheres(150, 1);
  RenderOptions options = test::small_options(32);
  for (const std::uint32_t samples : {1u, 2u}) {
    options.samples = samples;
    for (const std::uint32_t threads : {1u, 3u}) {
      options.threads = threads;
      const RenderResult entered = render(scene, options);
      EXPECT_TRUE(is_entered(entered));
      expect_same(entered, placed(scene, options));
      EXPECT_EQ(entered.statistics.triangles, scene.triangle_count());
    }
  }
  options.samples = 2;
  options.aperture = 0.2f;  // the ray through the middle of the image finds the focus
  const RenderResult entered = render(scene, options);
  EXPECT_TRUE(is_entered(entered));
  expect_same(entered, placed(scene, options));
}

TEST(Entered, AGroundCatchesTheShadowOfInstances) {
  SceneDescription scene = spheres(150, 2);
  scene.instances.erase(scene.instances.begin());  // the floor
  RenderOptions options = test::small_options(32);
  options.ground.emplace();
  const RenderResult entered = render(scene, options);
  EXPECT_TRUE(is_entered(entered));
  const RenderResult other = placed(scene, options);
  expect_same(entered, other);
  EXPECT_EQ(entered.ground, other.ground);
}

TEST(Entered, ScenesMoveAndChangeBetweenEnteredAndPlacedFrames) {
  SceneDescription scene = spheres(150, 3);
  std::mt19937 random(3);
  RenderOptions options = test::small_options(24);
  Renderer renderer;
  renderer.show(scene);
  for (int frame = 0; frame < 10; ++frame) {
    SCOPED_TRACE(frame);
    SceneChanges changes;
    if (frame > 0 && frame != 4) {
      for (std::uint32_t i = 2; i < scene.instances.size(); ++i) {
        if (random() % 3 == 0) continue;
        scene.instances[i].to_world = anywhere(&random, 4);
        changes.moved.push_back(i);
      }
    }
    if (frame == 5) {
      for (Vec3& p : scene.meshes[3].positions) p = p * 0.9f;
      changes.deformed = {3};
    }
    if (frame == 7) {
      scene.instances.resize(120);
      scene.meshes.back() = test::ball(16, 0.8f);
      changes = {};
      changes.other_meshes_from = static_cast<std::uint32_t>(scene.meshes.size() - 1);
      changes.other_instances_from = 0;
    }
    if (frame > 0) renderer.show(scene, changes);
    options.count_pixel_tests = frame == 2 || frame == 6;
    const RenderResult kept = renderer.render(options);
    EXPECT_EQ(is_entered(kept), !options.count_pixel_tests);
    EXPECT_EQ(renderer.last_update().placed_triangles == 0, is_entered(kept));
    expect_same(kept, placed(scene, options));
  }
}

TEST(Entered, AStillSceneIsPlacedOnceItsRaysPayForThat) {
  const SceneDescription scene = spheres(150, 4);
  const RenderOptions options = test::small_options(32);
  Renderer renderer;
  renderer.show(scene);
  int entered = 0;
  while (is_entered(renderer.render(options))) ASSERT_LT(++entered, 100);
  EXPECT_GT(entered, 1);
}

TEST(Entered, AMeshThatIsShownOnceIsPlaced) {
  SceneDescription scene = spheres(1, 5);
  const RenderOptions options = test::small_options(8);
  Renderer renderer;
  renderer.show(scene);
  for (int frame = 0; frame < 4; ++frame) {
    for (Vec3& p : scene.meshes[2].positions) p = p * 0.99f;
    SceneChanges changes;
    changes.deformed = {2};
    renderer.show(scene, changes);
    EXPECT_FALSE(is_entered(renderer.render(options)));
  }
}

TEST(Entered, InstancesThatRaysCannotEnterArePlaced) {
  SceneDescription scene = spheres(150, 6);
  scene.instances[20].to_world.m[1] = {0, 0, 0, 0.5f};  // flat
  const RenderOptions options = test::small_options(24);
  const RenderResult result = render(scene, options);
  EXPECT_FALSE(is_entered(result));
  expect_same(result, placed(scene, options));
  scene.instances[20].to_world.m[1] = {0, 1e18f, 0, 1e18f};
  EXPECT_THROW(static_cast<void>(render(scene, options)), Error);
}

TEST(Entered, MoreTrianglesThanArePlaced) {
  SceneDescription few = spheres(40, 7);
  few.meshes.push_back(test::ball(256, 1));
  Instance far_away;
  far_away.mesh = static_cast<std::uint32_t>(few.meshes.size() - 1);
  far_away.to_world.m[2][3] = 400;  // behind the camera and the lights
  SceneDescription many = few;
  for (std::uint32_t i = 0; i < 9000; ++i) {
    far_away.to_world.m[0][3] = static_cast<float>(i);
    many.instances.push_back(far_away);
  }
  ASSERT_GT(many.triangle_count(), std::uint64_t{1} << 31);
  RenderOptions options = test::small_options(24);
  options.primary = Primary::kRaster;                 // OpenGL cannot draw so many
  options.reflections = options.refractions = false;  // mirrors would show them
  const RenderResult result = render(many, options);
  EXPECT_TRUE(is_entered(result));
  EXPECT_EQ(result.statistics.primary, "trace: OpenGL would need all instances placed");
  EXPECT_EQ(result.statistics.triangles, many.triangle_count());
  options.primary = Primary::kTrace;
  expect_same(result, placed(few, options));
  many.instances[20].to_world.m[1] = {0, 0, 0, 0.5f};
  try {
    static_cast<void>(render(many, options));
    ADD_FAILURE() << "a flat instance was entered";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
    EXPECT_EQ(error.place(), "instances[20].to_world");
  }
  options.count_pixel_tests = true;
  EXPECT_THROW(static_cast<void>(render(many, options)), Error);
}

}  // namespace
}  // namespace raysheaf
