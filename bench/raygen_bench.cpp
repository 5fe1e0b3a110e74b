// Generates rays and keys from fragments. Argument: threads, 0 for all cores.
#include "rays/hash_body.h"
#include "support.h"

namespace raysheaf::bench {
namespace {

void shadow_rays(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  const Input& in = input();
  std::size_t rays = 0;
  for (auto _ : state) {
    const RayBatch batch = in.shadow_rays(executor, in.fragments);
    rays = batch.rays.size();
    benchmark::DoNotOptimize(batch.keys.data());
  }
  count_items(state, rays);
  state.counters["rays"] = static_cast<double>(rays);
  state.counters["per_ray"] = time_each(static_cast<double>(rays));
}

/// Makes every surface a mirror or glass.
Fragments all_specular(RayKind kind) {
  Fragments fragments = input().fragments;
  for (Fragment& f : fragments) {
    f.surface.roughness = 0;
    f.surface.specular = {0.9f, 0.9f, 0.9f};
    f.surface.transmission = kind == RayKind::kRefraction ? 1.0f : 0.0f;
    f.surface.transmission_color = {1, 1, 1};
  }
  return fragments;
}

template <RayKind kKind>
void bounce_rays(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  const Fragments fragments = all_specular(kKind);
  std::size_t rays = 0;
  for (auto _ : state) {
    const RayBatch batch = make_bounce_rays(executor, fragments, kKind, input().flat.bounds);
    rays = batch.rays.size();
    benchmark::DoNotOptimize(batch.keys.data());
  }
  count_items(state, rays);
  state.counters["rays"] = static_cast<double>(rays);
  state.counters["per_ray"] = time_each(static_cast<double>(rays));
}

/// Only the key, on one thread.
template <class Key>
void time_keys(benchmark::State& state, const Key& key) {
  const Executor executor;
  const LargeVector<Ray> rays = input().shadow_rays(executor, input().fragments).rays;
  for (auto _ : state) {
    std::uint32_t sum = 0;
    for (const Ray& ray : rays) sum += key(ray);
    benchmark::DoNotOptimize(sum);
  }
  count_items(state, rays.size());
  state.counters["per_key"] = time_each(static_cast<double>(rays.size()));
}

void shadow_keys(benchmark::State& state) {
  const ShadowKeyLayout layout = shadow_key_layout(1);
  time_keys(state,
            [&](const Ray& ray) { return shadow_key(layout, 0, octahedral(ray.direction)); });
}
void bounce_keys(benchmark::State& state) {
  const Box& box = input().flat.bounds;
  time_keys(state, [&](const Ray& ray) { return bounce_key(box, ray.origin, ray.direction); });
}

void one_and_all(benchmark::internal::Benchmark* bench) {
  bench->ArgName("threads")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(shadow_rays)->Apply(one_and_all);
BENCHMARK(bounce_rays<RayKind::kReflection>)->Apply(one_and_all);
BENCHMARK(bounce_rays<RayKind::kRefraction>)->Apply(one_and_all);
BENCHMARK(shadow_keys)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(bounce_keys)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace raysheaf::bench
