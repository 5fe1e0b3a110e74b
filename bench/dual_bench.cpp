// Sorting rays, and tracing them through the object tree, as bundles and as streams: mirror rays,
// ambient occlusion, and random rays. Arguments: the batch (0, 1, 2), then the sorting (0: by
// quarter, 1: along the curve), or the bundle (0: bundles, 1: streams) and whether the tree is
// finely built; threads (0: all cores) last.
#include "methods/dual/dual.h"

#include <algorithm>
#include <random>

#include "lab/lab_rays.h"
#include "support.h"

namespace raysheaf::bench {
namespace {

enum Rays { kMirror, kOcclusion, kRandom };

/// Triangles and batches of the bench scene, prepared once.
struct Trace {
  LargeVector<Ray> rays[3];
  ObjectTree trees[2];  ///< along a curve; finely built

  Trace() {
    const Executor executor;
    const FlatScene& flat = input().flat;
    TriangleSource source = flat.source();
    source.flags = nullptr;
    build_object_tree(executor, source, &trees[0]);
    build_fine_object_tree(executor, source, &trees[1]);
    const Vec3 size = flat.bounds.max - flat.bounds.min;
    rays[kMirror] = make_mirror_rays(executor, input().fragments, flat.bounds, 1).rays;
    rays[kOcclusion] =
        make_occlusion_rays(executor, input().fragments, flat.bounds, 0.25f * length(size)).rays;
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto point = [&] {
      return flat.bounds.min + Vec3{unit(engine), unit(engine), unit(engine)} * size;
    };
    while (rays[kRandom].size() < rays[kMirror].size()) {
      const Vec3 from = point(), to = point();
      if (!(from == to)) rays[kRandom].push_back({from, 0, normalized(to - from)});
    }
  }
};

const Trace& trace() {
  static const Trace the_trace;
  return the_trace;
}

const LargeVector<Ray>& rays_of(const benchmark::State& state) {
  return trace().rays[state.range(0)];
}

void order(benchmark::State& state) {
  const Executor executor = executor_of(state, 2);
  const LargeVector<Ray>& rays = rays_of(state);
  const Sorting sorting = state.range(1) == 0 ? Sorting::kByQuarter : Sorting::kCurve;
  RayOrder order;
  for (auto _ : state) {
    order_rays(executor, View<const Ray>(rays), sorting, &order);
    benchmark::DoNotOptimize(order.rays.data());
  }
  count_items(state, rays.size());
  state.counters["per_ray"] = time_each(static_cast<double>(rays.size()));
}
BENCHMARK(order)
    ->ArgNames({"rays", "curve", "threads"})
    ->ArgsProduct({{kMirror, kOcclusion, kRandom}, {0, 1}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// Times `query(executor, scene, rays, order, &counts)` in the best order for the bundle.
template <class Query>
void time_query(benchmark::State& state, const Query& query) {
  const Executor executor = executor_of(state, 3);
  const View<const Ray> rays(rays_of(state));
  DualScene scene;
  scene.bundle = static_cast<Bundle>(state.range(1));
  scene.tree = &trace().trees[state.range(2)];
  RayOrder order;
  const bool apart = scene.bundle == Bundle::kLongStream;
  order_rays(executor, rays, apart ? Sorting::kByQuarter : Sorting::kCurve, &order);
  DualCounts counts;
  for (auto _ : state) {
    counts = {};
    query(executor, scene, rays, order, &counts);
  }
  const auto n = static_cast<double>(rays.size);
  count_items(state, rays.size);
  state.counters["per_ray"] = time_each(n);
  state.counters["beam_boxes"] = static_cast<double>(counts.beam_box_tests) / n;
  state.counters["ray_boxes"] = static_cast<double>(counts.ray_box_tests) / n;
  state.counters["triangles"] = static_cast<double>(counts.triangle_tests) / n;
}

void closest(benchmark::State& state) {
  std::vector<IndexedHit> hits(rays_of(state).size());
  time_query(state, [&](const Executor& executor, const DualScene& scene, View<const Ray> rays,
                        const RayOrder& order, DualCounts* counts) {
    trace_rays(executor, scene, rays, order, {.hits = hits}, counts);
  });
  const auto found = std::count_if(
      hits.begin(), hits.end(), [](const IndexedHit& hit) { return hit.triangle != kInvalidId; });
  state.counters["found"] = static_cast<double>(found) / static_cast<double>(hits.size());
}
BENCHMARK(closest)
    ->ArgNames({"rays", "bundle", "fine", "threads"})
    ->ArgsProduct({{kMirror, kOcclusion, kRandom}, {0, 1}, {0, 1}, {1}})
    ->ArgsProduct({{kMirror, kOcclusion, kRandom}, {0, 1}, {0}, {2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void any(benchmark::State& state) {
  std::vector<std::uint8_t> occluded(rays_of(state).size());
  time_query(state, [&](const Executor& executor, const DualScene& scene, View<const Ray> rays,
                        const RayOrder& order, DualCounts* counts) {
    trace_rays(executor, scene, rays, order, {.occluded = occluded}, counts);
  });
  const auto found = std::count(occluded.begin(), occluded.end(), 1);
  state.counters["found"] = static_cast<double>(found) / static_cast<double>(occluded.size());
}
BENCHMARK(any)
    ->ArgNames({"rays", "bundle", "fine", "threads"})
    ->ArgsProduct({{kMirror, kOcclusion, kRandom}, {0, 1}, {0, 1}, {1}})
    ->ArgsProduct({{kMirror, kOcclusion, kRandom}, {0, 1}, {0}, {2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace raysheaf::bench
