// Shading of primary hits. Argument: threads, 0 for all cores; the automatic settings and the tone
// curve use one.
#include "render/shade/shade.h"

#include "support.h"

namespace raysheaf::bench {
namespace {

constexpr Vec3 kSky{0.1f, 0.1f, 0.1f};

void finish(benchmark::State& state) {
  count_items(state, input().fragments.size());
  state.counters["per_fragment"] = time_each(static_cast<double>(input().fragments.size()));
}

const std::vector<PlacedLight>& placed() {
  static const std::vector<PlacedLight> lights = placed_lights(input().scene.lights);
  return lights;
}

void glow(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  const Input& in = input();
  for (auto _ : state)
    benchmark::DoNotOptimize(shade_glow(executor, in.fragments, {kSky}, kAllBounces));
  finish(state);
}

void lights(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  const auto& fragments = input().fragments;
  std::vector<Visibility> visibility(fragments.size() * input().scene.lights.size());
  const RayBatch batch = input().shadow_rays(executor, fragments);
  for (const std::uint32_t slot : batch.slots) visibility[slot] = Visibility::kVisible;
  std::vector<Vec3> radiance(fragments.size());
  for (auto _ : state) {
    shade_lights(executor, fragments, {placed(), 0, {}}, visibility, radiance);
    benchmark::DoNotOptimize(radiance.data());
  }
  state.counters["lights"] = static_cast<double>(input().scene.lights.size());
  finish(state);
}

void into_pixels(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  const std::vector<Vec3> radiance(input().fragments.size(), kSky);
  std::vector<Vec3> pixels(input().fragments.size());
  for (auto _ : state) {
    accumulate(executor, input().fragments, radiance, pixels);
    benchmark::DoNotOptimize(pixels.data());
  }
  finish(state);
}

void sky(benchmark::State& state) {
  const Input& in = input();
  const Executor executor;
  for (auto _ : state)
    benchmark::DoNotOptimize(sky_of_parts(sky_parts(executor, in.fragments, placed())));
  finish(state);
}

/// An image with many brightnesses, lit without shadows.
RenderResult lit_picture() {
  const Executor executor;
  RenderResult result;
  result.width = kSize.width;
  result.height = kSize.height;
  const LargeVector<Vec3> glow = shade_glow(executor, input().fragments, {kSky}, kAllBounces);
  result.beauty.assign(glow.begin(), glow.end());
  const std::vector<Visibility> all(input().fragments.size() * input().scene.lights.size(),
                                    Visibility::kVisible);
  shade_lights(executor, input().fragments, {placed(), 0, {}}, all, result.beauty);
  result.ids.assign(result.beauty.size(), {0, 0, 0});
  return result;
}

void exposure(benchmark::State& state) {
  const RenderResult result = lit_picture();
  for (auto _ : state) benchmark::DoNotOptimize(automatic_exposure(result.beauty, result.ids));
  finish(state);
}

void tone_curve(benchmark::State& state) {
  const RenderResult result = lit_picture();
  for (auto _ : state) benchmark::DoNotOptimize(tone_mapped(result));
  finish(state);
}

void one_and_all(benchmark::internal::Benchmark* bench) {
  bench->ArgName("threads")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime();
}
void one(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(glow)->Apply(one_and_all);
BENCHMARK(lights)->Apply(one_and_all);
BENCHMARK(into_pixels)->Apply(one_and_all);
BENCHMARK(sky)->Apply(one);
BENCHMARK(exposure)->Apply(one);
BENCHMARK(tone_curve)->Apply(one);

}  // namespace
}  // namespace raysheaf::bench
