// The library's API: input is validated, copied and transformed to the world. The baseline of each
// benchmark is a plain copy of the same bytes by the C library on one thread.
#include <benchmark/benchmark.h>

#include <cstring>

#include "api/query_check.h"
#include "base/vec.h"
#include "raysheaf/query.h"

namespace raysheaf {
namespace {

constexpr std::size_t kVertices = 1 << 20;
constexpr std::size_t kRays = 1 << 18;

std::vector<Vec3> positions(std::size_t count) {
  std::vector<Vec3> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i % 1024), y = static_cast<float>(i / 1024);
    all[i] = {x, y, 0.001f * x * y};
  }
  return all;
}

void set_bytes(benchmark::State& state, std::size_t bytes) {
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes) * state.iterations());
}

void plain_copy(benchmark::State& state) {
  const std::vector<Vec3> from = positions(kVertices);
  std::vector<Vec3> to(kVertices);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), kVertices * sizeof(Vec3));
    benchmark::ClobberMemory();
  }
  set_bytes(state, kVertices * sizeof(Vec3));
}
BENCHMARK(plain_copy)->UseRealTime()->Unit(benchmark::kMillisecond);

/// A frame's update of 2^20 vertices. Arguments: threads, storage.
void update(benchmark::State& state) {
  const std::vector<Vec3> from = positions(kVertices - 1);
  Scene scene(Context({.threads = static_cast<std::uint32_t>(state.range(0))}));
  const MeshId mesh = scene.add_soup(from, {.storage = static_cast<Storage>(state.range(1))});
  for (auto _ : state) {
    scene.update(mesh, from);
    scene.commit();
  }
  set_bytes(state, from.size() * sizeof(Vec3));
}
BENCHMARK(update)
    ->ArgNames({"threads", "share"})
    ->ArgsProduct({{1, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// An update of the vertices while the instance rotates.
void update_and_transform(benchmark::State& state) {
  const std::vector<Vec3> from = positions(kVertices - 1);
  Scene scene(Context({.threads = static_cast<std::uint32_t>(state.range(0))}));
  const MeshId mesh = scene.add_soup(from, {.transform = rotation({0, 0, 1}, 1)});
  for (auto _ : state) {
    scene.update(mesh, from);
    scene.commit();
  }
  set_bytes(state, from.size() * sizeof(Vec3));
}
BENCHMARK(update_and_transform)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Many small meshes, all of which move in every frame.
void move_instances(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  Scene scene;
  const MeshId body = scene.add_soup(positions(36), {.place = false});
  std::vector<InstanceId> bodies(count);
  for (InstanceId& id : bodies) id = scene.instance(body, translation({1, 2, 3}));
  for (auto _ : state) {
    for (const InstanceId id : bodies)
      scene.set_transform(id, translation({static_cast<float>(id), 2, 3}));
    scene.commit();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(count) * state.iterations());
}
BENCHMARK(move_instances)->Arg(1000)->Arg(100000)->UseRealTime()->Unit(benchmark::kMillisecond);

/// Many small meshes, one of which is added or removed in every frame.
void list_instances(benchmark::State& state) {
  Scene scene;
  const MeshId body = scene.add_soup(positions(36), {.place = false});
  for (std::int64_t i = 0; i < state.range(0); ++i) scene.instance(body, translation({1, 2, 3}));
  InstanceId passing = scene.instance(body, Affine{});
  for (auto _ : state) {
    scene.remove_instance(passing);
    passing = scene.instance(body, Affine{});
    scene.commit();
  }
}
BENCHMARK(list_instances)->Arg(1000)->Arg(100000)->UseRealTime()->Unit(benchmark::kMillisecond);

/// Validates 2^18 rays.
void check(benchmark::State& state) {
  const Executor executor(static_cast<std::uint32_t>(state.range(0)));
  const std::vector<Ray> rays(kRays, Ray{{1, 2, 3}, 0, {4, 5, 6}});
  for (auto _ : state) check_rays(executor, rays);
  set_bytes(state, kRays * sizeof(Ray));
}
BENCHMARK(check)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

/// The fixed cost of a call: one ray, and one triangle far behind it.
void one_ray(benchmark::State& state) {
  Scene scene;
  scene.add_soup(std::vector<Vec3>{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
  scene.commit();
  const std::vector<Ray> rays(1, Ray{{1, 2, 3}, 0, {4, 5, 6}});
  std::vector<Hit> hits(1);
  for (auto _ : state) closest_hit(scene, rays, hits);
}
BENCHMARK(one_ray);

}  // namespace
}  // namespace raysheaf
