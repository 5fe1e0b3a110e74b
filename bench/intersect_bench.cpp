// The ray-triangle test: the SIMD kernel and a plain loop over the scalar test, in the same run.
// Argument: triangles per list. Rays are shadow rays from all over the image.
#include "intersect/brute_force.h"
#include "support.h"

namespace raysheaf::bench {
namespace {

std::vector<RaySetup> some_rays() {
  const Executor executor;
  const auto rays = input().shadow_rays(executor, input().fragments).rays;
  std::vector<RaySetup> setups;
  for (std::size_t i = 0; i < 64 && !rays.empty(); ++i)
    setups.push_back(make_ray_setup(rays[i * rays.size() / 64]));
  return setups;
}

template <class Intersect>
void time_lists(benchmark::State& state, const Intersect& intersect) {
  const std::vector<RaySetup> rays = some_rays();
  const std::uint32_t count =
      std::min(static_cast<std::uint32_t>(state.range(0)), input().flat.triangle_count);
  for (auto _ : state) {
    for (const RaySetup& ray : rays) {
      RayHit best;
      intersect(ray, count, &best);
      benchmark::DoNotOptimize(best);
    }
  }
  const std::size_t tests = rays.size() * count;
  count_items(state, tests);
  state.counters["per_test"] = time_each(static_cast<double>(tests));
}

void list_simd(benchmark::State& state) {
  const TriangleView triangles = input().arrays.view();
  time_lists(state, [&](const RaySetup& ray, std::uint32_t count, RayHit* best) {
    intersect_list(ray, triangle_run(triangles, 0, count), Facing::kBoth, best);
  });
}

void list_scalar(benchmark::State& state) {
  const TriangleView triangles = input().arrays.view();
  time_lists(state, [&](const RaySetup& ray, std::uint32_t count, RayHit* best) {
    for (std::uint32_t i = 0; i < count; ++i) {
      TriangleHit hit;
      if (intersect_triangle(ray, triangles.corner(i, 0), triangles.corner(i, 1),
                             triangles.corner(i, 2), &hit))
        best->take(hit.t, i);
    }
  });
}

void lists(benchmark::internal::Benchmark* bench) {
  bench->ArgName("triangles")->Arg(16)->Arg(64)->Arg(512)->Arg(8192);
  bench->Unit(benchmark::kMicrosecond)->UseRealTime();
}

BENCHMARK(list_simd)->Apply(lists);
BENCHMARK(list_scalar)->Apply(lists);

}  // namespace
}  // namespace raysheaf::bench
