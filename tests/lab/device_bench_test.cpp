// The benchmark of a device, run on an emulated device.
#include "lab/device_bench.h"
#include "emulated/open_emulated.h"

#include <gtest/gtest.h>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

TEST(DeviceBench, TimesEachStageAndFindsTheCpusHits) {
  const Executor executor(2);
  HostAllocator memory;
  const std::unique_ptr<DeviceBackend> backend = open_emulated(executor, memory);
  DeviceBenchOptions options;
  options.width = options.height = 80;
  options.runs = 1;
  const SceneDescription scene = builtin_scene("cornell");
  const DeviceBenchReport report = bench_device_on(*backend, scene, options);
  EXPECT_EQ(report.device, backend->name());
  EXPECT_GT(report.triangles, 0u);
  EXPECT_GT(report.copy_gb_per_s, 0);
  EXPECT_GT(report.gigaops_per_s, 0);
  ASSERT_EQ(report.batches.size(), 4u);
  for (const DeviceBenchBatch& batch : report.batches) {
    EXPECT_GT(batch.count, 0u);
    EXPECT_GT(batch.hits, 0u);
    EXPECT_EQ(batch.different, 0u);
    double sum = 0, with_floors = 0;
    for (const DeviceStage& stage : batch.stages) {
      EXPECT_GE(stage.ms, 0) << stage.name;
      if (!stage.name.starts_with("copy:")) sum += stage.ms;
      if (stage.floor_ms > 0) ++with_floors;
      EXPECT_EQ(stage.floor_of.empty(), stage.floor_ms == 0) << stage.name;
      if (stage.name.ends_with("hits") && stage.floor_ms > 0) {
        EXPECT_EQ(stage.floor_of, "operations") << stage.name << " of a cached scene";
      }
    }
    EXPECT_GE(with_floors, 7) << "of hierarchy and trace, and of the order of large batches";
    EXPECT_NEAR(batch.device_ms, sum, 1e-6 * sum) << "one run: its own median";
    EXPECT_LT(batch.trace_ms, batch.device_ms);
    EXPECT_GT(batch.keys_to_hits_ms, 0);
    EXPECT_GT(batch.cpu_ms, 0);
    EXPECT_GT(batch.call_ms, 0);
    EXPECT_GT(batch.frame_ms, batch.call_ms);
    double refit = 0;
    for (const DeviceStage& stage : batch.refit_stages) {
      EXPECT_TRUE(stage.name.starts_with("hierarchy:")) << stage.name;
      EXPECT_EQ(stage.floor_ms > 0, stage.name != "hierarchy: cost") << stage.name;
      refit += stage.ms;
    }
    EXPECT_GT(batch.refit_ms, 0);
    EXPECT_NEAR(batch.refit_ms, refit, 1e-6 * refit) << "one run: its own median";
    EXPECT_GT(batch.refit_frame_ms, batch.refit_ms);
  }
  options.rays = {LabRays::kReflection1};
  const DeviceBenchReport one = bench_device_on(*backend, scene, options);
  ASSERT_EQ(one.batches.size(), 1u);
  EXPECT_EQ(one.batches[0].rays, LabRays::kReflection1);
  options.runs = 0;
  EXPECT_THROW(static_cast<void>(bench_device_on(*backend, scene, options)), Error);
}

}  // namespace
}  // namespace raysheaf
