// Frames whose fragments stay on a device: every layer equals the CPU's, bit for bit. They run on
// an emulated device, and on a CUDA device if the machine has one.
#include <gtest/gtest.h>

#include <algorithm>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "frame/device_scenes.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "raysheaf/renderer.h"
#include "support/guarded_memory.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

/// Whether a sentence of the plan contains the words.
bool says(const RenderResult& result, const std::string& words) {
  for (const BatchStatistics& batch : result.statistics.batches)
    for (const std::string& sentence : batch.plan)
      if (sentence.find(words) != std::string::npos) return true;
  return false;
}

/// Whether fragments stayed on the device.
bool stayed(const RenderResult& result) {
  return says(result, "stay");
}

/// Compares a batch of the device with the CPU's; `tests`: also the numbers of tests.
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

/// Renders on the device and expects the CPU's image.
RenderResult expect_the_cpus(const Context& context, const SceneDescription& scene,
                             const RenderOptions& options) {
  const RenderResult here = render(scene, options);
  RenderResult there = render(context, scene, options);
  test::expect_same_picture(there, here);
  const auto &a = there.statistics.batches, &b = here.statistics.batches;
  EXPECT_EQ(a.size(), b.size());
  // A device's `dual` forms other bundles.
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    expect_same_batch(a[i], b[i], options.method != Method::kDual);
  EXPECT_EQ(there.statistics.samples.size(), here.statistics.samples.size());
  return there;
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
    // All kinds of rays at all bounces; and the primary rays hit something.
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
  // No surface is visible, or almost none.
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

/// The methods that sort their rays into a hierarchy or packets: tests also equal the CPU's.
void expect_frames_of_ordered_rays(const Context& context) {
  constexpr Method kMethods[] = {Method::kRah, Method::kCrsh, Method::kGl10};
  for (std::uint32_t seed = 50; seed < 59; ++seed) {
    SCOPED_TRACE(seed);
    SceneDescription scene = motley(seed, seed % 2 == 0);
    RenderOptions options = traced(32);
    options.method = kMethods[seed % 3];
    options.samples = seed == 52 || seed == 56 ? 2 : 1;
    if (seed == 53 || seed == 54 || seed == 58) options.key = RayKey::kRaster;
    // Only gl10 stops early; for the other methods a device makes all tests.
    options.early_out = seed == 56;
    if (seed >= 56) options.mesh_culling = false;
    if (seed == 57 || seed == 58) scene.environment = motley_sky(1);
    if (seed == 57 || seed == 58) options.primary = Primary::kRaster;
    options.levels = 1 + seed % 2;
    EXPECT_TRUE(stayed(expect_the_cpus(context, scene, options)));
  }
}

/// One renderer follows the changes from frame to frame.
void expect_frames_of_a_change(const Context& context, Method method) {
  SceneDescription scene = motley(30, true);
  Renderer here, there(context);
  here.show(scene);
  there.show(scene);
  RenderOptions options = traced(16);
  options.method = method;
  options.samples = 2;
  for (int frame = 0; frame < 6; ++frame) {
    SCOPED_TRACE(frame);
    const RenderResult result = there.render(options);
    test::expect_same_picture(result, here.render(options));
    if (method == Method::kDual) {
      EXPECT_EQ(says(result, "object tree: built"), frame == 0 || frame == 3);
      EXPECT_EQ(says(result, "object tree: refitted"), frame == 2 || frame == 4);
    }
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
      if (error.code() != ErrorCode::kUnsupported) throw;
      GTEST_SKIP() << error.what();
    }
  }
  const Executor executor_{2};
  test::GuardedMemory memory_;
  std::unique_ptr<Context> context_;
};

TEST_P(Frames, AreThoseOfTheCpu) {
  expect_all_frames(*context_);
}
TEST_P(Frames, OfSoftLight) {
  expect_soft_frames(*context_);
}
TEST_P(Frames, OfTheStudio) {
  SceneDescription scene = motley(21);
  scene.lights.clear();
  RenderOptions options = traced(48);
  options.samples = 2;
  const RenderResult room = expect_the_cpus(*context_, scene, options);
  EXPECT_TRUE(stayed(room));
  options.soft_boxes = false;
  const RenderResult plain = expect_the_cpus(*context_, scene, options);
  EXPECT_NE(room.beauty[48 * 24 + 24].x + room.exposure,
            plain.beauty[48 * 24 + 24].x + plain.exposure);
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

/// Whether OpenGL renders on the CUDA device depends on the machine.
TEST_P(Frames, TakeWhatOpenGlSeesFromItsMemoryOrThroughTheHost) {
  RenderOptions options = traced(48);
  options.primary = Primary::kRaster;
  options.samples = 2;
  const RenderResult result = expect_the_cpus(*context_, motley(60), options);
  EXPECT_TRUE(says(result, "OpenGL draws its triangles, and their image is read in place") ||
              (GetParam() && says(result, "copied there, because ")));
  setenv("RAYSHEAF_NO_INTEROP", "1", 1);
  const RenderResult copied = expect_the_cpus(*context_, motley(60), options);
  unsetenv("RAYSHEAF_NO_INTEROP");
  EXPECT_TRUE(says(copied, "copied there, because RAYSHEAF_NO_INTEROP is set"));
}

INSTANTIATE_TEST_SUITE_P(Devices, Frames, ::testing::Values(false, true),
                         [](const auto& param) { return param.param ? "Cuda" : "Emulated"; });

}  // namespace
}  // namespace raysheaf
