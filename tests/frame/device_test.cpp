// Frames whose rays are traced on a device equal the CPU's, bit for bit: on an emulated device, and
// on a CUDA device if the machine has one.
#include <gtest/gtest.h>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "support/guarded_memory.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

void expect_the_cpus_frame(const Context& context) {
  SceneDescription scene = test::ball_on_floor();
  scene.lights.push_back(test::point_light({-3, 2, 2}, 30));
  for (const Method method :
       {Method::kDual, Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10}) {
    RenderOptions options = test::small_options(method == Method::kDual ? 96 : 16);
    options.primary = Primary::kTrace;
    options.method = method;
    const bool hierarchy = method != Method::kDual && method != Method::kBrute;
    options.count_pixel_tests = !hierarchy;
    const RenderResult here = render(scene, options);
    const RenderResult there = render(context, scene, options);
    EXPECT_TRUE(test::same_bits(there.beauty, here.beauty));
    EXPECT_TRUE(test::same_bits(there.position, here.position));
    EXPECT_EQ(there.shadow, here.shadow);
    ASSERT_EQ(there.statistics.batches.size(), here.statistics.batches.size());
    for (std::size_t i = 0; i < here.statistics.batches.size(); ++i) {
      const BatchStatistics& batch = there.statistics.batches[i];
      EXPECT_EQ(batch.rays, here.statistics.batches[i].rays);
      EXPECT_EQ(batch.hits, here.statistics.batches[i].hits);
      EXPECT_GT(batch.final_tests, 0u);
      EXPECT_FALSE(batch.plan.empty());
      if (hierarchy) {
        EXPECT_EQ(batch.total_tests(), here.statistics.batches[i].total_tests());
      }
    }
    if (hierarchy) continue;
    double tests = 0;
    for (const float pixel : there.tests) tests += pixel;
    EXPECT_GT(tests, static_cast<double>(there.tests.size()));
  }
}

TEST(DeviceFrame, IsThatOfTheCpu) {
  const Executor executor(2);
  test::GuardedMemory memory;
  expect_the_cpus_frame(
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor, memory)));
}

TEST(DeviceFrame, IsThatOfTheCpuOnCuda) {
  std::unique_ptr<Context> context;
  try {
    context = std::make_unique<Context>(ContextOptions{.device = Device::kCuda});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kUnsupported) throw;
    GTEST_SKIP() << error.what();
  }
  expect_the_cpus_frame(*context);
}

}  // namespace
}  // namespace raysheaf
