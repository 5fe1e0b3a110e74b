// Scenes whose instances move, placed by a device: the CPU's frames, bit for bit, and what is sent
// does not grow with the triangles. On the CPU as a device.
#include <gtest/gtest.h>

#include <random>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "frame/device_scenes.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "raysheaf/renderer.h"
#include "render/raster/rasterizer.h"
#include "support/guarded_memory.h"

namespace raysheaf {
namespace {

bool has_opengl() {
  try {
    const Rasterizer rasterizer;
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Whether a sentence of the plan has these words.
bool plan_says(const RenderResult& result, const std::string& words) {
  for (const BatchStatistics& batch : result.statistics.batches)
    for (const std::string& sentence : batch.plan)
      if (sentence.find(words) != std::string::npos) return true;
  return false;
}

SceneChanges moved(std::uint32_t instance) {
  SceneChanges changes;
  changes.moved = {instance};
  return changes;
}

/// Turned, stretched, mirrored now and then, and moved.
Affine shaken(const Affine& at, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  Affine by;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t c = 0; c < 4; ++c) by.m[row][c] += 0.15f * unit(random);
  if (random() % 4 == 0)
    for (auto& row : by.m) row[0] = -row[0];
  return compose(at, by);
}

/// Moves some of the instances.
SceneChanges shake(SceneDescription* scene, std::mt19937& random) {
  SceneChanges changes;
  for (std::uint32_t i = 0; i < scene->instances.size(); ++i) {
    if (i != 0 && random() % 2 == 0) continue;
    Instance& instance = scene->instances[i];
    instance.to_world = shaken(instance.to_world, random);
    changes.moved.push_back(i);
  }
  return changes;
}

class PlacedFrames : public ::testing::Test {
 protected:
  const Executor executor_{2};
  test::GuardedMemory memory_;
  const Context device_ =
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor_, memory_));

  /// Frames of a scene that is shaken, there and here.
  void expect_shaken(SceneDescription scene, const RenderOptions& options, bool there_places) {
    std::mt19937 random(7);
    Renderer here, there(device_);
    here.show(scene);
    there.show(scene);
    for (int frame = 0; frame < 4; ++frame) {
      SCOPED_TRACE(frame);
      const RenderResult picture = there.render(options);
      test::expect_same_picture(picture, here.render(options));
      EXPECT_EQ(plan_says(picture, "device: places"), there_places && frame > 0);
      EXPECT_EQ(plan_says(picture, "the host places"), !there_places && frame > 0);
      EXPECT_EQ(there.last_update().placed_triangles, here.last_update().placed_triangles);
      const SceneChanges changes = shake(&scene, random);
      here.show(scene, changes);
      there.show(scene, changes);
    }
  }

  /// Bytes that each frame after the first two sends, of a sphere of so many rings that moves.
  std::vector<std::uint64_t> sent(std::uint32_t rings, const RenderOptions& options) {
    SceneDescription scene = test::ball_on_floor();
    scene.meshes[0] = test::ball(rings, 1, {0, 1, 0});
    scene.meshes[0].materials = {0};
    Renderer renderer(device_);
    renderer.show(scene);
    std::vector<std::uint64_t> bytes;
    for (int frame = 0; frame < 4; ++frame) {
      const std::uint64_t before = memory_.uploaded_bytes();
      static_cast<void>(renderer.render(options));
      bytes.push_back(memory_.uploaded_bytes() - before);
      scene.instances[0].to_world.m[0][3] += 0.1f;
      renderer.show(scene, moved(0));
    }
    EXPECT_GT(bytes[0], 36 * scene.triangle_count());
    bytes.erase(bytes.begin(), bytes.begin() + 2);
    return bytes;
  }
};

TEST_F(PlacedFrames, OfBuiltinScenesAreTheCpus) {
  for (const std::string& name : builtin_scene_names()) {
    SCOPED_TRACE(name);
    expect_shaken(builtin_scene(name), traced(48), true);
  }
}

TEST_F(PlacedFrames, OfAnyMethodAreTheCpus) {
  for (const Method method :
       {Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10, Method::kDual}) {
    SCOPED_TRACE(to_string(method));
    RenderOptions options = traced(12);
    options.method = method;
    expect_shaken(motley(70, true), options, true);
    expect_shaken(behind_curtains(), options, true);
    options.samples = 2;
    options.aperture = 0.1f;
    options.focus = 3;
    expect_shaken(motley(71), options, true);
  }
}

TEST_F(PlacedFrames, DrawnByOpenGlAreTheCpus) {
  if (!has_opengl()) GTEST_SKIP() << "no OpenGL 4.5 context here";
  for (const bool gbuffer : {false, true}) {
    RenderOptions options = traced(40);
    options.primary = Primary::kRaster;
    options.gbuffer = gbuffer;
    expect_shaken(motley(72), options, true);
    expect_shaken(builtin_scene("cornell"), options, true);
  }
  setenv("RAYSHEAF_NO_INTEROP", "1", 1);
  RenderOptions options = traced(24);
  options.primary = Primary::kRaster;
  expect_shaken(motley(73), options, false);
  unsetenv("RAYSHEAF_NO_INTEROP");
}

/// Triangles that the host needs are placed by the host.
TEST_F(PlacedFrames, OfWhatNeedsTheHost) {
  RenderOptions options = traced(24);
  options.samples = 2;
  options.aperture = 0.1f;
  expect_shaken(motley(75), options, false);
}

/// The host catches up with what the device has placed, and goes on.
TEST_F(PlacedFrames, TakeTurnsWithTheHosts) {
  std::mt19937 random(8);
  SceneDescription scene = motley(76);
  Renderer here, there(device_);
  here.show(scene);
  there.show(scene);
  for (int frame = 0; frame < 12; ++frame) {
    SCOPED_TRACE(frame);
    RenderOptions options = traced(20);
    if (frame % 4 == 3) options.method = Method::kGl10;
    if (frame % 3 == 2 && has_opengl()) options.primary = Primary::kRaster;
    const RenderResult picture = there.render(options);
    test::expect_same_picture(picture, here.render(options));
    SceneChanges changes;
    if (frame != 6) changes = shake(&scene, random);  // else nothing moves
    if (frame == 4) {
      changes.deformed = {4};
      for (Vec3& p : scene.meshes[4].positions) p.y *= 1.1f;
    }
    if (frame == 8) {
      changes.other_instances_from = static_cast<std::uint32_t>(scene.instances.size());
      scene.instances.push_back(scene.instances[2]);
      scene.instances.back().to_world.m[0][3] += 0.5f;
    }
    here.show(scene, changes);
    there.show(scene, changes);
  }
}

TEST_F(PlacedFrames, SendNoMoreForMoreTriangles) {
  for (const Method method : {Method::kDual, Method::kCrsh, Method::kBrute}) {
    SCOPED_TRACE(to_string(method));
    RenderOptions options = traced(8);
    options.method = method;
    options.bounces = 0;
    const std::vector<std::uint64_t> few = sent(6, options);
    EXPECT_EQ(sent(40, options), few);
    EXPECT_LT(few[0], 1000u);
  }
  if (!has_opengl()) return;
  RenderOptions options = traced(8);
  options.primary = Primary::kRaster;
  EXPECT_EQ(sent(40, options), sent(6, options));
}

/// The host reports a vertex that goes too far; the renderer goes on.
TEST_F(PlacedFrames, TellWhichInstanceGoesTooFar) {
  SceneDescription scene = motley(77);
  Renderer there(device_);
  there.show(scene);
  const RenderOptions options = traced(16);
  static_cast<void>(there.render(options));
  const Affine home = scene.instances[3].to_world;
  scene.instances[3].to_world.m[1][3] = 1e19f;
  there.show(scene, moved(3));
  try {
    static_cast<void>(there.render(options));
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
    EXPECT_EQ(error.place(), "instances[3].to_world");
  }
  scene.instances[3].to_world = home;
  there.show(scene, moved(3));
  test::expect_same_picture(there.render(options), render(scene, options));
}

}  // namespace
}  // namespace raysheaf
