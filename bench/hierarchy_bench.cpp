// Builds ray bounds bottom-up over the shadow rays of an image, sorted by their keys. Arguments:
// branching, levels, threads (0 for all cores).
#include "methods/ray_hierarchy/hierarchy.h"

#include "support.h"

namespace raysheaf::bench {
namespace {

void build(benchmark::State& state) {
  const Executor executor = executor_of(state, 2);
  static const std::vector<Ray> rays = ordered_shadow_rays(true);
  const auto branching = static_cast<std::uint32_t>(state.range(0));
  const auto levels = static_cast<std::uint32_t>(state.range(1));
  std::size_t nodes = 0;
  for (auto _ : state) {
    const RayHierarchy<RayBound> tree =
        build_hierarchy<RayBound>(executor, rays, input().flat.bounds, branching, levels);
    nodes = 0;
    for (const auto& level : tree.levels) nodes += level.size();
    benchmark::DoNotOptimize(tree.levels.back().data());
  }
  count_items(state, rays.size());
  state.counters["nodes"] = static_cast<double>(nodes);
  state.counters["node_bytes_per_ray"] =
      static_cast<double>(nodes * sizeof(RayBound)) / static_cast<double>(rays.size());
  state.counters["per_ray"] = time_each(static_cast<double>(rays.size()));
}

BENCHMARK(build)
    ->ArgNames({"branching", "levels", "threads"})
    ->ArgsProduct({{8}, {1, 2, 4}, {1, 0}})
    ->ArgsProduct({{2, 16, 64}, {2}, {1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace raysheaf::bench
