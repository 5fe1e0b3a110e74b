// The node test, as a SIMD kernel and as a plain loop in the same run; the complete traversal; and
// the counts of the traversal with other keys than those of raygen.
#include "methods/ray_hierarchy/traverse.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/bits.h"
#include "methods/ray_hierarchy/node_filter.h"
#include "rays/hash_body.h"
#include "support.h"

namespace raysheaf::bench {
namespace {

const RayHierarchy<RayBound>& sorted_tree() {
  static const auto tree =
      build_hierarchy<RayBound>(Executor(), ordered_shadow_rays(true), input().flat.bounds, 8, 2);
  return tree;
}

/// Nodes from all over the image: the time depends on how many triangles pass a node's test.
std::vector<ConeSphereTest> some_nodes(std::uint32_t level) {
  const std::vector<RayBound>& nodes = sorted_tree().level(level);
  std::vector<ConeSphereTest> tests;
  for (std::size_t i = 0; i < 16 && !nodes.empty(); ++i)
    tests.push_back(make_cone_sphere_test(nodes[i * nodes.size() / 16]));
  return tests;
}

FieldPointers<kBallFields> spheres_of(const TriangleView& triangles) {
  return {triangles.sphere[0], triangles.sphere[1], triangles.sphere[2], triangles.sphere[3]};
}

/// Each list has at most `state.range(1)` spheres, from the first triangles of the scene.
template <class Filter>
void time_filter(benchmark::State& state, const Filter& run) {
  const auto nodes = some_nodes(static_cast<std::uint32_t>(state.range(0)));
  const std::uint32_t count =
      std::min(static_cast<std::uint32_t>(state.range(1)), input().flat.triangle_count);
  std::vector<std::uint32_t> out(count + kTriangleBlock);
  std::uint64_t met = 0;
  for (auto _ : state) {
    met = 0;
    for (const ConeSphereTest& node : nodes) met += run(node, count, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  const std::size_t tests = nodes.size() * count;
  count_items(state, tests);
  state.counters["per_test"] = time_each(static_cast<double>(tests));
  state.counters["part_met"] = static_cast<double>(met) / static_cast<double>(tests);
}

void filter_simd(benchmark::State& state) {
  const auto spheres = spheres_of(input().arrays.view());
  time_filter(state, [&](const ConeSphereTest& node, std::uint32_t count, std::uint32_t* out) {
    return filter(node, spheres, count, out);
  });
}

void filter_scalar(benchmark::State& state) {
  const auto s = spheres_of(input().arrays.view());
  time_filter(state, [&](const ConeSphereTest& node, std::uint32_t count, std::uint32_t* out) {
    std::uint32_t met = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      out[met] = i;
      met += meets(node, {s[0][i], s[1][i], s[2][i]}, s[3][i]) ? 1 : 0;
    }
    return met;
  });
}

/// The counts of one traversal and the time of each kind of test, summed over threads.
void report(benchmark::State& state, const TraverseCounts& counts, double rays) {
  double node_tests = 0;
  for (const std::uint64_t tests : counts.tests) node_tests += static_cast<double>(tests);
  const auto final_tests = static_cast<double>(counts.final_tests);
  state.counters["node_tests_per_ray"] = node_tests / rays;
  state.counters["final_tests_per_ray"] = final_tests / rays;
  state.counters["ns_per_node_test"] = counts.node_seconds * 1e9 / node_tests;
  state.counters["ns_per_final_test"] = counts.final_seconds * 1e9 / final_tests;
}

void walk(benchmark::State& state, bool crsh) {
  const Executor executor = executor_of(state, 0);
  const std::vector<Ray> rays = ordered_shadow_rays(crsh);
  const auto tree = build_hierarchy<RayBound>(executor, rays, input().flat.bounds, 8, 2);
  TraverseOptions options;
  options.mesh_culling = crsh;
  ProgressMeter meter;
  TraverseCounts counts;
  for (auto _ : state) {
    std::vector<RayHit> best(rays.size());
    counts = traverse(executor, input().arrays.view(), View<const FlatMesh>(input().flat.meshes),
                      tree, rays, options, best, {}, &meter);
    benchmark::DoNotOptimize(best.data());
  }
  count_items(state, rays.size());
  report(state, counts, static_cast<double>(rays.size()));
}

void walk_crsh(benchmark::State& state) {
  walk(state, true);
}
void walk_rah(benchmark::State& state) {
  walk(state, false);
}

/// The sphere as azimuth and polar angle, each in [0, 1].
Vec2 azimuth_polar(Vec3 direction) {
  constexpr float kPi = 3.14159265f;
  const Vec3 d = normalized(direction);
  return {std::atan2(d.y, d.x) / (2 * kPi) + 0.5f, std::acos(clamp(d.z, -1, 1)) / kPi};
}

std::uint32_t side_by_side(Vec2 place, std::uint32_t bits) {
  return quantized(place.x, bits) << bits | quantized(place.y, bits);
}

/// Spreads sixteen bits, with a zero above each: `...0d 0c 0b 0a`.
std::uint32_t spread_by_2(std::uint32_t x) {
  x &= 0x0000ffffu;
  x = (x | (x << 8)) & 0x00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0fu;
  x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}

enum class Key { kNone, kAngles5, kAngles8, kMorton8, kOwn };

/// The upper sixteen bits are raygen's key of the light. The lower bits are: nothing; the angles
/// with 5 or 8 bits each; the octahedral map with 8 bits each, interleaved; or raygen's key.
std::uint32_t shadow_key_of(Key key, const Ray& ray, std::uint32_t own) {
  const std::uint32_t light = own & 0xffff0000u;
  const Vec2 square = octahedral(ray.direction);
  switch (key) {
    case Key::kNone:
      return light;
    case Key::kAngles5:
      return light | side_by_side(azimuth_polar(ray.direction), 5);
    case Key::kAngles8:
      return light | side_by_side(azimuth_polar(ray.direction), 8);
    case Key::kMorton8:
      return light | spread_by_2(quantized(square.x, 8)) | spread_by_2(quantized(square.y, 8)) << 1;
    default:
      return own;
  }
}

/// For rays from anywhere: nothing; the angles of the origin around the scene's centre above those
/// of the direction (5 bits each; 8 and 7); or raygen's key.
std::uint32_t bounce_key_of(Key key, const Ray& ray, std::uint32_t own) {
  const Box& box = input().flat.bounds;
  const Vec2 from = azimuth_polar(ray.origin - (box.min + box.max) * 0.5f);
  const Vec2 along = azimuth_polar(ray.direction);
  switch (key) {
    case Key::kNone:
      return 0;
    case Key::kAngles5:
      return side_by_side(from, 5) << 10 | side_by_side(along, 5);
    case Key::kAngles8:
      return side_by_side(from, 8) << 14 | side_by_side(along, 7);
    default:
      return own;
  }
}

/// The tests of one batch in the order of some key, with mesh culling: only the counts matter here.
void count_tests(benchmark::State& state, const RayBatch& batch,
                 const std::vector<std::uint32_t>& keys) {
  const Executor executor;
  std::vector<std::uint32_t> order(keys.size());
  BatchStatistics total;
  for (auto _ : state) {
    order_by_key(executor, keys, order);
    std::vector<Ray> rays;
    for (const std::uint32_t ray : order) rays.push_back(batch.rays[ray]);
    const auto tree = build_hierarchy<RayBound>(executor, rays, input().flat.bounds, 8, 2);
    std::vector<RayHit> best(rays.size());
    ProgressMeter meter;
    const TraverseCounts counts =
        traverse(executor, input().arrays.view(), View<const FlatMesh>(input().flat.meshes), tree,
                 rays, {}, best, {}, &meter);
    total.final_tests =
        std::accumulate(counts.tests.begin(), counts.tests.end(), counts.final_tests);
  }
  total.rays = batch.rays.size();
  total.triangles = input().flat.triangle_count;
  state.counters["rays"] = static_cast<double>(total.rays);
  state.counters["relative_percent"] = 100 * total.relative();
}

template <Key kKey>
void tests_of_shadow_rays(benchmark::State& state) {
  const RayBatch batch = input().shadow_rays(Executor(), input().fragments);
  std::vector<std::uint32_t> keys;
  for (std::size_t i = 0; i < batch.rays.size(); ++i)
    keys.push_back(shadow_key_of(kKey, batch.rays[i], batch.keys[i]));
  count_tests(state, batch, keys);
}

/// Reflections, with every surface made a mirror.
template <Key kKey>
void tests_of_mirror_rays(benchmark::State& state) {
  Fragments fragments = input().fragments;
  for (Fragment& f : fragments) {
    f.surface.roughness = f.surface.transmission = 0;
    f.surface.specular = {1, 1, 1};
  }
  const RayBatch batch =
      make_bounce_rays(Executor(), fragments, RayKind::kReflection, input().flat.bounds);
  std::vector<std::uint32_t> keys;
  for (std::size_t i = 0; i < batch.rays.size(); ++i)
    keys.push_back(bounce_key_of(kKey, batch.rays[i], batch.keys[i]));
  count_tests(state, batch, keys);
}

void lists(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"level", "spheres"})
      ->ArgsProduct({{1, 2}, {256, 8192}})
      ->Unit(benchmark::kMicrosecond)
      ->UseRealTime();
}
void one_and_all(benchmark::internal::Benchmark* bench) {
  bench->ArgName("threads")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime();
}

void once(benchmark::internal::Benchmark* bench) {
  bench->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(filter_simd)->Apply(lists);
BENCHMARK(filter_scalar)->Apply(lists);
BENCHMARK(walk_crsh)->Apply(one_and_all);
BENCHMARK(walk_rah)->Apply(one_and_all);
BENCHMARK(tests_of_shadow_rays<Key::kNone>)->Apply(once);
BENCHMARK(tests_of_shadow_rays<Key::kAngles5>)->Apply(once);
BENCHMARK(tests_of_shadow_rays<Key::kAngles8>)->Apply(once);
BENCHMARK(tests_of_shadow_rays<Key::kMorton8>)->Apply(once);
BENCHMARK(tests_of_shadow_rays<Key::kOwn>)->Apply(once);
BENCHMARK(tests_of_mirror_rays<Key::kNone>)->Apply(once);
BENCHMARK(tests_of_mirror_rays<Key::kAngles5>)->Apply(once);
BENCHMARK(tests_of_mirror_rays<Key::kAngles8>)->Apply(once);
BENCHMARK(tests_of_mirror_rays<Key::kOwn>)->Apply(once);

}  // namespace
}  // namespace raysheaf::bench
