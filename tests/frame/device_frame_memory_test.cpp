// Frames on a device that runs out of memory at any of its allocations.
#include <gtest/gtest.h>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "frame/device_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "raysheaf/renderer.h"
#include "support/device_memory.h"
#include "support/guarded_memory.h"

namespace raysheaf {
namespace {

/// Whichever allocation fails, there is one sentence, nothing leaks, and the next frame is right.
void expect_memory_may_run_out(const SceneDescription& scene, const RenderOptions& options) {
  const Executor executor(2);
  test::GuardedMemory memory;
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
        test::expect_same_picture(fresh.render(options), here);
        break;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << error.what();
        EXPECT_FALSE(error.place().empty());
      }
      allocator.let(test::FailingAllocator::kAlways);
      if (allocations % 8 == 0) test::expect_same_picture(fresh.render(options), here);
    }
    EXPECT_GT(allocations, 40u);
    allocator.let(test::FailingAllocator::kAlways);
  }
  EXPECT_EQ(allocator.alive(), 0u);
}

/// The same where instances move after a first frame.
TEST(DeviceFrameMemory, MayRunOutWhereInstancesMove) {
  const Executor executor(2);
  test::GuardedMemory memory;
  test::FailingAllocator allocator(memory);
  SceneDescription scene = motley(42);
  RenderOptions options = traced(16);
  options.bounces = 1;
  const Context context = ContextAccess::with_backend({.device = Device::kCuda},
                                                      open_emulated(executor, memory, &allocator));
  std::uint64_t allocations = 0;
  for (bool done = false; !done; ++allocations) {
    Renderer renderer(context);
    renderer.show(scene);
    static_cast<void>(renderer.render(options));
    scene.instances[2].to_world.m[0][3] += 0.01f;
    SceneChanges changes;
    changes.moved = {2};
    renderer.show(scene, changes);
    allocator.let(allocations);
    const RenderResult here = render(scene, options);
    try {
      test::expect_same_picture(renderer.render(options), here);
      done = true;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << error.what();
    }
    allocator.let(test::FailingAllocator::kAlways);
    if (allocations % 2 == 0) test::expect_same_picture(renderer.render(options), here);
  }
  EXPECT_GT(allocations, 3u);
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
