// The scene stage: mesh bounds once per scene, flattening and transformed bounds once per frame.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "base/vec.h"
#include "exec/executor.h"
#include "scene/flat_scene.h"
#include "scene/mesh_bound_body.h"
#include "surface/surface.h"

namespace raysheaf {
namespace {

/// A wavy sheet of 2 n^2 triangles.
Mesh sheet(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(n);
      const float v = static_cast<float>(y) / static_cast<float>(n);
      mesh.positions.push_back({u, 0.1f * std::sin(20 * u) * std::cos(15 * v), v});
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t i = y * (n + 1) + x;
      mesh.triangles.push_back({i, i + n + 1, i + 1});
      mesh.triangles.push_back({i + 1, i + n + 1, i + n + 2});
    }
  }
  return mesh;
}

/// `meshes` sheets in a row, with `triangles` in total.
SceneDescription sheets(std::int64_t triangles, std::int64_t meshes) {
  SceneDescription scene;
  const double each = static_cast<double>(triangles) / static_cast<double>(meshes);
  const Mesh mesh = sheet(static_cast<std::uint32_t>(std::sqrt(each / 2)));
  for (std::int64_t i = 0; i < meshes; ++i) {
    scene.meshes.push_back(mesh);
    scene.instances.push_back(
        {"", static_cast<std::uint32_t>(i), translation({static_cast<float>(i), 0, 0})});
  }
  return scene;
}

void count_triangles(benchmark::State& state, const SceneDescription& scene) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(scene.triangle_count()));
}

void mesh_bounds_of(benchmark::State& state) {
  const SceneDescription scene = sheets(state.range(0), state.range(1));
  const Executor executor;
  for (auto _ : state) benchmark::DoNotOptimize(mesh_bounds(executor, scene));
  count_triangles(state, scene);
}
BENCHMARK(mesh_bounds_of)
    ->Args({66450, 1})
    ->Args({36308, 299})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void flatten_scene(benchmark::State& state) {
  const SceneDescription scene = sheets(state.range(0), state.range(1));
  const Executor executor(static_cast<std::uint32_t>(state.range(2)));
  const auto bounds = mesh_bounds(executor, scene);
  for (auto _ : state) benchmark::DoNotOptimize(flatten(executor, scene, bounds));
  count_triangles(state, scene);
}
BENCHMARK(flatten_scene)
    ->Args({66450, 1, 1})
    ->Args({66450, 1, 0})
    ->Args({36308, 299, 0})
    ->Args({1000000, 1, 0})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void move_bounds(benchmark::State& state) {
  const Affine map = compose(rotation({0, 1, 0}, 0.3f), scaling({1, 2, 3}));
  const Sphere sphere{{1, 2, 3}, 4};
  for (auto _ : state) {
    for (int i = 0; i < 1000; ++i) benchmark::DoNotOptimize(transformed(sphere, map));
  }
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(move_bounds);

void look_at_surfaces(benchmark::State& state) {
  const SceneDescription scene = sheets(66450, 1);
  const Executor executor;
  const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
  const TextureSet textures(scene);
  std::uint32_t triangle = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(surface_at(flat, textures, triangle, 0.3f, 0.3f, {0, -1, 0}));
    triangle = (triangle + 1) % flat.triangle_count;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(look_at_surfaces);

}  // namespace
}  // namespace raysheaf
