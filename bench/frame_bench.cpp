// A complete shadow batch by each method, and complete frames, flattening included. Argument:
// threads, 0 for all cores. Brute force runs on 64 x 64 pixels, the others on 512 x 512.
#include "render/frame/frame.h"
#include "render/geometry/resident_geometry.h"

#include <sys/resource.h>

#include <memory>

#include "support.h"

namespace raysheaf::bench {
namespace {

/// The peak memory of the process so far: run a single benchmark to see its own.
double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

template <Method kMethod>
void shadow_batch(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  const bool brute = kMethod == Method::kBrute;
  const Fragments fragments = input().fragments_at(executor, brute ? PictureSize{64, 64} : kSize);
  const RayBatch batch = input().shadow_rays(executor, fragments);
  TraceOptions options;
  options.method = method_settings(kMethod);
  ProgressMeter meter;
  BatchStatistics statistics;
  for (auto _ : state) {
    statistics = {};
    benchmark::DoNotOptimize(
        trace(executor, input().flat, batch, options, &statistics, {}, &meter));
  }
  count_items(state, batch.rays.size());
  const auto rays = static_cast<double>(batch.rays.size());
  state.counters["rays"] = rays;
  state.counters["tests_per_ray"] = static_cast<double>(statistics.total_tests()) / rays;
  state.counters["relative_percent"] = 100 * statistics.relative();
  state.counters["peak_mib"] = peak_mib();
}

std::unique_ptr<Rasterizer> rasterizer_or_none() {
  try {
    return std::make_unique<Rasterizer>();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNoGraphics) throw;
    return nullptr;
  }
}

template <Method kMethod>
void whole_frame(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  const std::unique_ptr<Rasterizer> rasterizer = rasterizer_or_none();
  RenderOptions options;
  options.method = kMethod;
  options.primary = rasterizer ? Primary::kRaster : Primary::kTrace;
  state.SetLabel(rasterizer ? rasterizer->description() : "traced primary rays");
  const SceneDescription& scene = input().scene;
  const std::vector<Sphere> bounds = mesh_bounds(executor, scene);
  const std::vector<PlacedLight> lights = placed_lights(scene.lights);
  std::size_t rays = 0;
  for (auto _ : state) {
    const FlatScene flat = flatten(executor, scene, bounds);
    ResidentGeometry geometry(executor, flat, input().textures, options);
    const FrameInput frame{geometry, scene.cameras.front(), lights, options, 1, rasterizer.get()};
    const RenderResult result = render_frame(executor, frame);
    rays = 0;
    for (const BatchStatistics& batch : result.statistics.batches) rays += batch.rays;
    benchmark::DoNotOptimize(result.beauty.data());
  }
  count_items(state, rays);
  state.counters["rays"] = static_cast<double>(rays);
  state.counters["peak_mib"] = peak_mib();
}

void one_and_all(benchmark::internal::Benchmark* bench) {
  bench->ArgName("threads")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(shadow_batch<Method::kBrute>)->Apply(one_and_all);
BENCHMARK(shadow_batch<Method::kRah>)->Apply(one_and_all);
BENCHMARK(shadow_batch<Method::kCrsh>)->Apply(one_and_all);
BENCHMARK(shadow_batch<Method::kDual>)->Apply(one_and_all);
BENCHMARK(whole_frame<Method::kRah>)->Apply(one_and_all);
BENCHMARK(whole_frame<Method::kCrsh>)->Apply(one_and_all);
BENCHMARK(whole_frame<Method::kDual>)->Apply(one_and_all);

}  // namespace
}  // namespace raysheaf::bench
