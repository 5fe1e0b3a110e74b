// Frames whose rays meet triangles on a device are those of the CPU, bit for bit: on the CPU as a
// device, and on the CUDA device where there is one.
#include <gtest/gtest.h>

#include "frame/frame.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

RenderResult frame_of(const SceneDescription& scene, const RenderOptions& options,
                      const DeviceBackend* backend) {
  const Executor executor(2);
  ProgressMeter meter;
  const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
  const TextureSet textures(scene);
  TraceCache cache;
  cache.backend = backend;
  FrameInput input{flat, textures, scene.cameras.front(), scene.lights, options};
  input.cache = &cache;
  return render_frame(executor, input, &meter);
}

void expect_the_cpus_frame(const DeviceBackend& backend) {
  SceneDescription scene = test::ball_on_floor();
  scene.lights.push_back(test::point_light({-3, 2, 2}, 30));
  for (const Method method : {Method::kDual, Method::kBrute, Method::kRah, Method::kCrsh}) {
    RenderOptions options = test::small_options(method == Method::kDual ? 96 : 16);
    options.primary = Primary::kTrace;
    options.method = method;
    const bool hierarchy = method == Method::kRah || method == Method::kCrsh;
    options.count_pixel_tests = !hierarchy;
    const RenderResult here = frame_of(scene, options, nullptr);
    const RenderResult there = frame_of(scene, options, &backend);
    EXPECT_TRUE(test::same_bits(there.beauty, here.beauty));
    EXPECT_TRUE(test::same_bits(there.position, here.position));
    EXPECT_EQ(there.shadow, here.shadow);
    ASSERT_EQ(there.statistics.batches.size(), here.statistics.batches.size());
    for (std::size_t i = 0; i < here.statistics.batches.size(); ++i) {
      const BatchStatistics& batch = there.statistics.batches[i];
      EXPECT_EQ(batch.rays, here.statistics.batches[i].rays);
      EXPECT_EQ(batch.hits, here.statistics.batches[i].hits);
      EXPECT_GT(batch.final_tests, 0u);
      EXPECT_EQ(batch.plan.empty(), hierarchy);
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
  HostAllocator memory;
  expect_the_cpus_frame(*open_emulated(executor, memory));
}

TEST(DeviceFrame, IsThatOfTheCpuOnCuda) {
  std::unique_ptr<DeviceBackend> backend;
  try {
    backend = open_cuda();
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  expect_the_cpus_frame(*backend);
}

}  // namespace
}  // namespace raysheaf
