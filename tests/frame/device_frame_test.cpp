// Frames whose fragments stay on a device: every layer is the CPU's, bit for bit. On the CPU as a
// device, and on the CUDA device where there is one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "api/context_impl.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/render_on_context.h"
#include "raysheaf/renderer.h"
#include "support/device_memory.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

void expect_same_picture(const RenderResult& there, const RenderResult& here) {
  EXPECT_EQ(there.width, here.width);
  EXPECT_EQ(there.height, here.height);
  EXPECT_EQ(there.samples, here.samples);
  EXPECT_TRUE(test::same_bits(there.beauty, here.beauty));
  EXPECT_TRUE(test::same_bits(there.position, here.position));
  EXPECT_TRUE(test::same_bits(there.normal, here.normal));
  EXPECT_TRUE(test::same_bits(there.albedo, here.albedo));
  EXPECT_TRUE(test::same_bits(there.specular, here.specular));
  EXPECT_EQ(there.shadow, here.shadow);
  EXPECT_EQ(there.exposure, here.exposure);
  EXPECT_TRUE(test::same_bits({there.ambient}, {here.ambient}));
  ASSERT_EQ(there.ids.size(), here.ids.size());
  for (std::size_t i = 0; i < here.ids.size(); ++i) {
    ASSERT_EQ(there.ids[i].geom_id, here.ids[i].geom_id) << i;
    ASSERT_EQ(there.ids[i].inst_id, here.ids[i].inst_id) << i;
    ASSERT_EQ(there.ids[i].prim_id, here.ids[i].prim_id) << i;
  }
}

/// Whether a sentence of the plan says so.
bool says(const RenderResult& result, const std::string& words) {
  for (const BatchStatistics& batch : result.statistics.batches)
    for (const std::string& sentence : batch.plan)
      if (sentence.find(words) != std::string::npos) return true;
  return false;
}

/// Whether fragments were the device's.
bool stayed(const RenderResult& result) {
  return says(result, "stay");
}

/// A batch there and here; `tests`: what they count, too.
void expect_same_batch(const BatchStatistics& there, const BatchStatistics& here, bool tests) {
  EXPECT_EQ(there.kind, here.kind);
  EXPECT_EQ(there.bounce, here.bounce);
  EXPECT_EQ(there.rays, here.rays);
  EXPECT_EQ(there.hits, here.hits);
  EXPECT_EQ(there.triangles, here.triangles);
  EXPECT_EQ(there.chunks, here.chunks);
  if (!tests) return;
  EXPECT_EQ(there.total_tests(), here.total_tests());
  EXPECT_EQ(there.mesh_sphere_tests, here.mesh_sphere_tests);
  ASSERT_EQ(there.levels.size(), here.levels.size());
  for (std::size_t l = 0; l < there.levels.size(); ++l) {
    EXPECT_EQ(there.levels[l].tests, here.levels[l].tests);
    EXPECT_EQ(there.levels[l].hits, here.levels[l].hits);
  }
}

/// The picture on the device, after it was compared with the CPU's.
RenderResult expect_the_cpus(const Context& context, const SceneDescription& scene,
                             const RenderOptions& options) {
  const RenderResult here = render(scene, options);
  RenderResult there = render(context, scene, options);
  expect_same_picture(there, here);
  const auto &a = there.statistics.batches, &b = here.statistics.batches;
  EXPECT_EQ(a.size(), b.size());
  // A device's `dual` has other bundles.
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    expect_same_batch(a[i], b[i], options.method != Method::kDual);
  EXPECT_EQ(there.statistics.samples.size(), here.statistics.samples.size());
  return there;
}

/// Everything that a frame on a device knows, in one scene: textures that are turned, scaled and
/// mirrored, glass, a mirror, metal, lamps, an instance that mirrors, triangles without material,
/// normal or area, and lights of all kinds; `soft`: a ball and a rectangle, too.
SceneDescription motley(std::uint32_t seed, bool soft = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  SceneDescription scene = test::ball_on_floor();
  for (std::uint32_t i = 0; i < 2; ++i) {
    Image image;
    image.width = 5 + i;
    image.height = 3;
    for (std::uint32_t k = 0; k < image.width * image.height * 4; ++k)
      image.rgba.push_back(static_cast<std::uint8_t>(random() & 255));
    scene.images.push_back(image);
    scene.textures.push_back({i, static_cast<Wrap>(i), Wrap::kMirroredRepeat,
                              i == 0 ? Filter::kLinear : Filter::kNearest});
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    Material material;
    material.base_color = {unit(random), unit(random), unit(random), 1};
    if (i % 2 == 0)
      material.base_color_texture = {i / 2 % 2, {0.3f, 0.1f}, {2, 3}, 0.7f * static_cast<float>(i)};
    if (i % 3 == 0) material.metallic_roughness_texture.texture = 1;
    if (i == 5) material.emission_texture.texture = 0;
    if (i % 4 < 2) material.normal_texture = {1, {0, 0}, {3, 1}, 0.3f};
    material.normal_scale = 0.4f * static_cast<float>(i);
    if (i == 5) material.emission = {2, 1, 0.5f};
    material.metallic = i % 4 == 1 ? 1.0f : 0.0f;
    material.roughness = i % 4 == 1 ? 0.02f : unit(random);
    material.transmission = i == 2 || i == 6 ? 0.9f : 0.0f;
    material.ior = i == 6 ? 0.0f : 1.4f;
    material.specular = unit(random);
    material.unlit = i == 7;
    material.double_sided = i % 3 != 2;
    scene.materials.push_back(material);
  }
  const auto materials = static_cast<std::uint32_t>(scene.materials.size());
  for (std::uint32_t i = 0; i < 8; ++i) {
    Mesh ball = test::ball(5, 0.4f);
    if (i % 2 == 0) ball.normals.clear();
    if (i != 3)
      for (const Vec3 p : ball.positions) ball.uvs.push_back({2 * p.x, p.y - p.z});
    if (i % 3 != 0)
      for (const Vec3 p : ball.positions) ball.colors.push_back(abs(p) * 2);
    for (std::size_t t = 0; i > 4 && t < ball.triangles.size(); ++t)
      ball.materials.push_back(static_cast<std::uint32_t>(random() % materials));
    if (i == 4) ball.materials = {};
    if (i < 4) ball.materials = {materials - 1 - i};
    ball.triangles.push_back({1, 1, 2});
    if (i > 4) ball.materials.push_back(0);
    scene.meshes.push_back(ball);
    Instance placed;
    placed.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
    for (int axis = 0; axis < 3; ++axis) {
      for (int c = 0; c < 3; ++c)
        placed.to_world.m[axis][c] = (axis == c ? 1.0f : 0.0f) + 0.4f * (unit(random) - 0.5f);
      placed.to_world.m[axis][3] = (axis == 1 ? 1.5f : 4) * unit(random) - (axis == 1 ? 0 : 2);
    }
    if (i % 3 == 0)
      for (auto& row : placed.to_world.m) row[0] = -row[0];
    scene.instances.push_back(placed);
    if (i == 6) scene.instances.push_back(placed);  // in the same place
  }
  Light spot = test::point_light({2, 4, 1}, 60);
  spot.type = Light::Type::kSpot;
  spot.direction = {-0.4472136f, -0.8944272f, 0};
  spot.outer_angle = 0.6f;
  Light sun = test::point_light({0, 0, 0}, 1.5f);
  sun.type = Light::Type::kDirectional;
  sun.direction = {0.6f, -0.8f, 0};
  Light near = test::point_light({-1, 2, 2}, 10);
  near.range = 3;
  scene.lights.insert(scene.lights.end(), {spot, sun, near});
  if (!soft) return scene;
  scene.lights[0].radius = 0.3f;
  scene.lights[1].radius = 0.1f;
  Light plate = test::point_light({0, 3, -1}, 5);
  plate.type = Light::Type::kRectangle;
  plate.direction = {0, -1, 0};
  plate.right = {1, 0, 0};
  plate.width = 1.5f;
  plate.height = 0.5f;
  scene.lights.push_back(plate);
  return scene;
}

/// With a small sun.
Environment motley_sky(float rotation) {
  Environment sky;
  sky.width = 8;
  sky.height = 4;
  sky.intensity = 0.7f;
  sky.rotation = rotation;
  for (std::uint32_t i = 0; i < sky.width * sky.height; ++i) {
    const float x = 0.03f * static_cast<float>(i);
    sky.radiance.push_back(i == 11 ? Vec3{30, 20, 10} : Vec3{x, 1 - x, 0.5f});
  }
  return sky;
}

/// Mirrors and glass before and behind curtains, one of them in another's place, and a pane that is
/// there by chance.
SceneDescription behind_curtains() {
  Material glass;
  glass.transmission = 0.7f;
  glass.roughness = 0;
  SceneDescription scene = test::ball_on_floor(glass);
  test::add_curtain(&scene, 1.5f, 1);
  test::add_curtain(&scene, 2, 2);
  test::add_curtain(&scene, 2, 3);
  Material mist;
  mist.alpha_blend = true;
  mist.double_sided = true;
  mist.base_color = {0.3f, 0.4f, 0.5f, 0.5f};
  scene.materials.push_back(mist);
  Mesh pane = test::floor_square(5, 1.2f);
  pane.materials = {static_cast<std::uint32_t>(scene.materials.size()) - 1};
  test::add_mesh(&scene, std::move(pane));
  return scene;
}

RenderOptions traced(std::uint32_t size) {
  RenderOptions options = test::small_options(size);
  options.primary = Primary::kTrace;
  options.bounces = 3;
  return options;
}

void expect_all_frames(const Context& context) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    RenderOptions options = traced(64);
    options.samples = seed % 3 == 1 ? 3 : 1;
    options.bounces = seed;
    options.method = seed == 2 ? Method::kBrute : Method::kDual;
    options.reflections = seed != 4;
    options.refractions = seed != 5;
    if (seed == 3) options.ambient = Vec3{0.1f, 0.2f, 0.3f};
    if (seed == 2) options.width = 40;
    const RenderResult there = expect_the_cpus(context, motley(seed), options);
    EXPECT_TRUE(stayed(there));
    if (seed != 3) continue;
    // All kinds of rays at all bounces, and the first ones meet something.
    EXPECT_EQ(there.statistics.batches.size(), 1 + 4 + 3 + 3u);
    for (const BatchStatistics& batch : there.statistics.batches) {
      if (batch.bounce <= 1) {
        EXPECT_GT(batch.hits, 0u);
      }
    }
  }
  SceneDescription scene = motley(9);
  scene.lights.clear();
  scene.materials[0].emission = {};
  expect_the_cpus(context, scene, traced(40));
  RenderOptions options = traced(40);
  options.shadows = false;
  expect_the_cpus(context, motley(10), options);
  // Nothing to see, and next to nothing.
  SceneDescription behind = motley(11);
  behind.cameras = {test::camera_at({0, 0, 50}, {0, 0, 100})};
  expect_the_cpus(context, behind, traced(16));
  options = traced(1);
  options.width = 1;
  expect_the_cpus(context, motley(12), options);
}

/// Lights with a size, lenses and environments, with one sample and with several.
void expect_soft_frames(const Context& context) {
  for (std::uint32_t seed = 20; seed < 26; ++seed) {
    SCOPED_TRACE(seed);
    SceneDescription scene = motley(seed, true);
    RenderOptions options = traced(40);
    options.samples = seed % 3 == 2 ? 1 : 4;
    if (seed % 2 == 1) options.aperture = 0.1f;
    if (seed == 22 || seed >= 24) {
      scene.environment = motley_sky(0.4f * static_cast<float>(seed));
      if (seed == 25) std::ranges::fill(scene.environment.radiance, Vec3{0, 0, 0});
      options.reflections = seed != 24;
    }
    EXPECT_TRUE(stayed(expect_the_cpus(context, scene, options)));
  }
}

/// The methods that order their rays, into a hierarchy or packets: the CPU's tests, too.
void expect_frames_of_ordered_rays(const Context& context) {
  constexpr Method kMethods[] = {Method::kRah, Method::kCrsh, Method::kGl10};
  for (std::uint32_t seed = 50; seed < 59; ++seed) {
    SCOPED_TRACE(seed);
    SceneDescription scene = motley(seed, seed % 2 == 0);
    RenderOptions options = traced(32);
    options.method = kMethods[seed % 3];
    options.samples = seed == 52 || seed == 56 ? 2 : 1;
    if (seed == 53 || seed == 54 || seed == 58) options.key = RayKey::kRaster;
    options.early_out = seed == 56;  // by gl10: of the others a device makes all tests
    if (seed >= 56) options.mesh_culling = false;
    if (seed == 57 || seed == 58) scene.environment = motley_sky(1);
    if (seed == 57 || seed == 58) options.primary = Primary::kRaster;
    options.levels = 1 + seed % 2;
    EXPECT_TRUE(stayed(expect_the_cpus(context, scene, options)));
  }
}

/// One renderer, from frame to frame.
void expect_frames_of_a_change(const Context& context, Method method) {
  SceneDescription scene = motley(30, true);
  Renderer here, there(context);
  here.show(scene);
  there.show(scene);
  RenderOptions options = traced(32);
  options.method = method;
  options.samples = 2;
  for (int frame = 0; frame < 6; ++frame) {
    SCOPED_TRACE(frame);
    expect_same_picture(there.render(options), here.render(options));
    SceneChanges changes;
    if (frame == 1 || frame == 3) {
      changes.moved = {2};
      scene.instances[2].to_world.m[0][3] += 0.2f;
      changes.deformed = {4};
      for (Vec3& p : scene.meshes[4].positions) p.y *= 1.1f;
      for (Vec3& n : scene.meshes[4].normals) n = {n.y, n.z, n.x};
    } else if (frame == 2) {
      changes.everything = true;
      scene.materials[1].base_color = {1, 0, 0, 1};
      scene.images[0].rgba[0] ^= 255;
      scene.environment = motley_sky(1);
    }
    scene.lights[0].intensity = {20, 30, 40};
    here.show(scene, changes);
    there.show(scene, changes);
  }
}

class Frames : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (!GetParam()) {
      context_ = std::make_unique<Context>(ContextAccess::with_backend(
          {.device = Device::kCuda}, open_emulated(executor_, memory_)));
      return;
    }
    try {
      context_ = std::make_unique<Context>(ContextOptions{.device = Device::kCuda});
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
  }
  const Executor executor_{2};
  HostAllocator memory_;
  std::unique_ptr<Context> context_;
};

TEST_P(Frames, AreThoseOfTheCpu) {
  expect_all_frames(*context_);
}
TEST_P(Frames, OfSoftLight) {
  expect_soft_frames(*context_);
}
TEST_P(Frames, OfCutouts) {
  const SceneDescription scene = behind_curtains();
  for (const Method method :
       {Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10, Method::kDual}) {
    SCOPED_TRACE(to_string(method));
    RenderOptions options = traced(32);
    options.method = method;
    options.count_pixel_tests = method == Method::kBrute || method == Method::kDual;
    options.early_out = method == Method::kGl10;
    EXPECT_TRUE(stayed(expect_the_cpus(*context_, scene, options)));
    options.samples = 3;
    EXPECT_TRUE(stayed(expect_the_cpus(*context_, scene, options)));
    options.primary = Primary::kRaster;
    EXPECT_TRUE(stayed(expect_the_cpus(*context_, scene, options)));
    options.shadows = false;
    EXPECT_TRUE(stayed(expect_the_cpus(*context_, scene, options)));
  }
}
TEST_P(Frames, OfOrderedRays) {
  expect_frames_of_ordered_rays(*context_);
}
TEST_P(Frames, CountTheTestsOfPixels) {
  for (const Method method : {Method::kBrute, Method::kDual}) {
    RenderOptions options = traced(32);
    options.count_pixel_tests = true;
    options.method = method;
    options.samples = 2;
    const SceneDescription scene = motley(20, true);
    const RenderResult result = expect_the_cpus(*context_, scene, options);
    EXPECT_TRUE(stayed(result));
    double pixels = 0, batches = 0;
    for (const float tests : result.tests) pixels += double{tests};
    for (const BatchStatistics& batch : result.statistics.batches)
      batches += static_cast<double>(batch.total_tests());
    EXPECT_EQ(pixels, batches);
    if (method == Method::kBrute) {
      EXPECT_EQ(result.tests, render(scene, options).tests);
    }
    options.count_pixel_tests = false;
    EXPECT_TRUE(render(*context_, scene, options).tests.empty());
  }
}
TEST_P(Frames, FollowWhatChanges) {
  for (const Method method : {Method::kDual, Method::kCrsh, Method::kGl10, Method::kBrute}) {
    SCOPED_TRACE(to_string(method));
    expect_frames_of_a_change(*context_, method);
  }
}
TEST_P(Frames, OfBuiltinScenesByBothKindsOfPrimaryVisibility) {
  for (const std::string& name : builtin_scene_names()) {
    SCOPED_TRACE(name);
    RenderOptions options = traced(96);
    EXPECT_TRUE(stayed(expect_the_cpus(*context_, builtin_scene(name), options)));
    options.primary = Primary::kRaster;
    EXPECT_TRUE(stayed(expect_the_cpus(*context_, builtin_scene(name), options)));
  }
}

/// Whether OpenGL draws on the CUDA device is the machine's affair.
TEST_P(Frames, TakeWhatOpenGlSeesFromItsMemoryOrThroughTheHost) {
  RenderOptions options = traced(48);
  options.primary = Primary::kRaster;
  options.samples = 2;
  const RenderResult result = expect_the_cpus(*context_, motley(60), options);
  EXPECT_TRUE(says(result, "read where it lies") ||
              (GetParam() && says(result, "copied there, for ")));
  setenv("RAYSHEAF_NO_INTEROP", "1", 1);
  const RenderResult copied = expect_the_cpus(*context_, motley(60), options);
  unsetenv("RAYSHEAF_NO_INTEROP");
  EXPECT_TRUE(says(copied, "copied there, for RAYSHEAF_NO_INTEROP is set"));
}

INSTANTIATE_TEST_SUITE_P(Devices, Frames, ::testing::Values(false, true),
                         [](const auto& param) { return param.param ? "Cuda" : "Emulated"; });

/// Whichever allocation fails: one sentence, nothing left, and the next frame is right.
void expect_memory_may_run_out(const SceneDescription& scene, const RenderOptions& options) {
  const Executor executor(2);
  HostAllocator memory;
  test::FailingAllocator allocator(memory);
  const RenderResult here = render(scene, options);
  {
    const Context context = ContextAccess::with_backend(
        {.device = Device::kCuda}, open_emulated(executor, memory, &allocator));
    Renderer renderer(context);
    renderer.show(scene);
    std::uint64_t allocations = 0;
    for (;; ++allocations) {
      Renderer fresh(context);
      fresh.show(scene);
      allocator.let(allocations);
      try {
        expect_same_picture(fresh.render(options), here);
        break;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << error.what();
        EXPECT_FALSE(error.place().empty());
      }
      allocator.let(test::FailingAllocator::kAlways);
      if (allocations % 8 == 0) expect_same_picture(fresh.render(options), here);
    }
    EXPECT_GT(allocations, 40u);
    allocator.let(test::FailingAllocator::kAlways);
  }
  EXPECT_EQ(allocator.alive(), 0u);
}

TEST(DeviceFrameMemory, MayRunOutAnywhere) {
  SceneDescription scene = motley(40, true);
  scene.environment = motley_sky(1);
  expect_memory_may_run_out(scene, traced(24));
}

TEST(DeviceFrameMemory, MayRunOutInHoles) {
  RenderOptions options = traced(16);
  options.primary = Primary::kRaster;
  options.method = Method::kCrsh;
  options.bounces = 1;
  expect_memory_may_run_out(behind_curtains(), options);
}

TEST(DeviceFrameMemory, MayRunOutWherePicturesAreRead) {
  RenderOptions options = traced(16);
  options.primary = Primary::kRaster;
  options.bounces = 0;
  expect_memory_may_run_out(motley(41), options);
}

}  // namespace
}  // namespace raysheaf
