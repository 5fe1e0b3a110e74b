// Packets and their tree, step by step, compared with the ray hierarchy of `crsh` on the same rays.
// Arguments: threads. Labels: the kind of rays.
#include <benchmark/benchmark.h>

#include <numeric>
#include <optional>
#include <random>

#include "methods/packets/frustum_body.h"
#include "methods/packets/packet_traverse.h"
#include "methods/ray_hierarchy/hierarchy.h"
#include "methods/ray_hierarchy/traverse.h"
#include "rays/hash_body.h"
#include "rays/order/order.h"
#include "raysheaf/builtin_scenes.h"
#include "scene/flat_arrays.h"

namespace raysheaf {
namespace {

constexpr std::size_t kRays = 512 * 512;

enum class Kind { kFan, kScattered };

/// Sorted rays of one kind through the atrium. Fan: from one light to random points. Scattered:
/// between random points.
struct Work {
  SceneDescription description = builtin_scene("atrium");
  FlatScene scene;
  std::optional<FlatArrays> arrays;  ///< of `scene`
  std::vector<Ray> rays;             ///< in their original order
  std::vector<Ray> ordered;
  std::vector<std::uint32_t> order, keys;  ///< keys ascending

  explicit Work(Kind kind) {
    const Executor executor;
    scene = flatten(executor, description, mesh_bounds(executor, description));
    arrays.emplace(executor, scene);
    std::mt19937 random(7);
    const auto somewhere = [&] {
      std::uniform_real_distribution<float> unit(0.02f, 0.98f);
      const Vec3 size = scene.bounds.max - scene.bounds.min;
      return scene.bounds.min + size * Vec3{unit(random), unit(random), unit(random)};
    };
    const Vec3 light = somewhere();
    std::vector<std::uint32_t> unsorted;
    for (std::size_t i = 0; i < kRays; ++i) {
      const Vec3 origin = kind == Kind::kFan ? light : somewhere();
      rays.push_back({origin, 0, somewhere() - origin, 1});
      unsorted.push_back(bounce_key(scene.bounds, origin, rays.back().direction));
    }
    order.resize(kRays);
    order_by_key(executor, unsorted, order, kBounceKeyBits);
    for (const std::uint32_t ray : order) {
      ordered.push_back(rays[ray]);
      keys.push_back(unsorted[ray]);
    }
  }
};

const Work& work_of(Kind kind) {
  static const Work fan(Kind::kFan), scattered(Kind::kScattered);
  return kind == Kind::kFan ? fan : scattered;
}

Executor executor_of(const benchmark::State& state) {
  return Executor(static_cast<std::uint32_t>(state.range(0)));
}

void count(benchmark::State& state, std::size_t items) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
}

void tree(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Work& work = work_of(Kind::kFan);
  for (auto _ : state) benchmark::DoNotOptimize(build_bvh(executor, work.arrays->view()));
  count(state, work.scene.triangle_count);
}

template <Kind kKind>
void cut(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Work& work = work_of(kKind);
  for (auto _ : state) {
    std::vector<std::uint32_t> order = work.order;
    const auto packets =
        make_packets(executor, work.rays, work.keys, kBounceKeyBits, kPacketRays, order);
    state.counters["packets"] = static_cast<double>(packets.size());
  }
  count(state, kRays);
}

/// Reports tests per ray, in addition to the time.
void show_tests(benchmark::State& state, const std::vector<std::uint64_t>& tests,
                std::uint64_t final_tests) {
  const auto sum = std::accumulate(tests.begin(), tests.end(), final_tests);
  state.counters["tests/ray"] = static_cast<double>(sum) / kRays;
  count(state, kRays);
}

template <Kind kKind>
void packets(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Work& work = work_of(kKind);
  const Bvh bvh = build_bvh(executor, work.arrays->view());
  std::vector<std::uint32_t> order = work.order;
  const auto most_rays = static_cast<std::uint32_t>(state.range(1));
  const auto cuts = make_packets(executor, work.rays, work.keys, kBounceKeyBits, most_rays, order);
  std::vector<Ray> rays;
  for (const std::uint32_t ray : order) rays.push_back(work.rays[ray]);
  ProgressMeter meter;
  PacketCounts counts;
  for (auto _ : state) {
    std::vector<RayHit> best(kRays);
    counts = traverse_packets(executor, work.arrays->view(), bvh, cuts, rays, {}, best, {}, &meter);
  }
  show_tests(state, counts.tests, counts.final_tests);
}

template <Kind kKind>
void ray_hierarchy(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Work& work = work_of(kKind);
  ProgressMeter meter;
  TraverseCounts counts;
  for (auto _ : state) {
    const auto hierarchy =
        build_hierarchy<RayBound>(executor, work.ordered, work.scene.bounds, 8, 2);
    std::vector<RayHit> best(kRays);
    counts = traverse(executor, work.arrays->view(), View<const FlatMesh>(work.scene.meshes),
                      hierarchy, work.ordered, {}, best, {}, &meter);
  }
  show_tests(state, counts.tests, counts.final_tests);
}

void threads(benchmark::internal::Benchmark* bench) {
  bench->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
}
void sizes(benchmark::internal::Benchmark* bench) {
  for (const int most_rays : {16, 32, 64, 128, 256}) bench->Args({2, most_rays});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(tree)->Apply(threads);
BENCHMARK(cut<Kind::kFan>)->Apply(threads);
BENCHMARK(cut<Kind::kScattered>)->Apply(threads);
BENCHMARK(packets<Kind::kFan>)->Apply(sizes);
BENCHMARK(packets<Kind::kScattered>)->Apply(sizes);
BENCHMARK(ray_hierarchy<Kind::kFan>)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(ray_hierarchy<Kind::kScattered>)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace raysheaf
