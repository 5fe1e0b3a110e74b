// The object tree: rebuilt along a curve, also coarsely, refitted, built finely; compared with
// Embree's fast build and refit, if the build found Embree, on the same triangles and threads.
// Arguments: thousands of triangles, threads. RAYSHEAF_BENCH_LARGE=1 adds ten million.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "object_tree/object_tree.h"

#ifdef RAYSHEAF_BENCH_EMBREE
#include <embree3/rtcore.h>
#include <xmmintrin.h>
#endif

namespace raysheaf::bench {
namespace {

using Index = std::array<std::uint32_t, 3>;

/// Positions have an extra element at the end, because Embree reads sixteen bytes of each.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Index> indices;
};

enum Shape { kGrid, kSoup };

/// A square of small waves with shared vertices.
Mesh make_grid(std::uint32_t triangles) {
  const auto side = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0));
  Mesh mesh;
  for (std::uint32_t y = 0; y <= side; ++y)
    for (std::uint32_t x = 0; x <= side; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(side);
      const float v = static_cast<float>(y) / static_cast<float>(side);
      mesh.positions.push_back({u, 0.1f * std::sin(20 * u) * std::cos(17 * v), v});
    }
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x, b = a + side + 1;
      mesh.indices.push_back({a, a + 1, b});
      mesh.indices.push_back({b, a + 1, b + 1});
    }
  mesh.positions.push_back({});
  return mesh;
}

/// Small random triangles in a cube, in random order.
Mesh make_soup(std::uint32_t triangles) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> unit(0, 1);
  const float size = 0.5f / std::cbrt(static_cast<float>(triangles));
  Mesh mesh;
  const auto point = [&] { return Vec3{unit(engine), unit(engine), unit(engine)}; };
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3 at = point();
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = point();
      mesh.positions.push_back({at.x + size * p.x, at.y + size * p.y, at.z + size * p.z});
    }
    mesh.indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.positions.push_back({});
  return mesh;
}

const Mesh& mesh_of(Shape shape, std::uint32_t triangles) {
  static std::map<std::pair<Shape, std::uint32_t>, Mesh> meshes;
  const auto [at, is_new] = meshes.try_emplace({shape, triangles});
  if (is_new) at->second = shape == kGrid ? make_grid(triangles) : make_soup(triangles);
  return at->second;
}

struct Input {
  Input(Shape shape, const benchmark::State& state)
      : mesh(mesh_of(shape, static_cast<std::uint32_t>(state.range(0) * 1000))),
        executor(static_cast<std::uint32_t>(state.range(1))) {
    const auto count = static_cast<std::uint32_t>(mesh.indices.size());
    run = {mesh.positions.data(), mesh.indices.data(), 0, count};
    source = {{&run, 1}, count, nullptr};
  }
  const Mesh& mesh;
  Executor executor;
  TriangleRun run;
  TriangleSource source;
};

void describe(const ObjectTree& tree, benchmark::State& state) {
  const double count = tree.triangles;
  state.counters["cost"] = tree.surface_area_cost;
  state.counters["B/tri"] = static_cast<double>(tree.nodes.size() * sizeof(BvhNode) +
                                                tree.quads.size() * sizeof(TriangleQuad)) /
                            count;
  state.counters["B/tri_all"] = static_cast<double>(tree.memory_bytes()) / count;
  state.counters["tri/quad"] = count / static_cast<double>(tree.quads.size());
  state.counters["tri/node"] = count / static_cast<double>(tree.nodes.size());
}

template <Shape kShape, class Step>
void time_tree(benchmark::State& state, const Step& step) {
  const Input in(kShape, state);
  ObjectTree tree;
  build_object_tree(in.executor, in.source, &tree);
  for (auto _ : state) step(in, &tree);
  describe(tree, state);
}

template <Shape kShape>
void rebuild(benchmark::State& state) {
  time_tree<kShape>(state, [](const Input& in, ObjectTree* tree) {
    build_object_tree(in.executor, in.source, tree);
  });
}

template <Shape kShape>
void coarse(benchmark::State& state) {
  time_tree<kShape>(state, [](const Input& in, ObjectTree* tree) {
    build_object_tree(in.executor, in.source, tree, {kCoarseTriangles});
  });
}

template <Shape kShape>
void refit(benchmark::State& state) {
  time_tree<kShape>(state, [](const Input& in, ObjectTree* tree) {
    if (!refit_object_tree(in.executor, in.source, MovedTriangles::everything(), tree))
      std::abort();
  });
}

template <Shape kShape>
void fine(benchmark::State& state) {
  time_tree<kShape>(state, [](const Input& in, ObjectTree* tree) {
    build_fine_object_tree(in.executor, in.source, tree);
  });
}

#ifdef RAYSHEAF_BENCH_EMBREE

template <Shape kShape>
void embree(benchmark::State& state, RTCBuildQuality geometry_quality,
            RTCBuildQuality scene_quality) {
  _mm_setcsr(_mm_getcsr() | 0x8040);  // flushes subnormal numbers to zero, as Embree recommends
  const Input in(kShape, state);
  const RTCDevice device =
      rtcNewDevice(("threads=" + std::to_string(in.executor.threads())).c_str());
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, scene_quality);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, geometry_quality);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             in.mesh.positions.data(), 0, sizeof(Vec3),
                             in.mesh.positions.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             in.mesh.indices.data(), 0, sizeof(Index), in.mesh.indices.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcCommitScene(scene);
  for (auto _ : state) {
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry);
    rtcCommitScene(scene);
  }
  rtcReleaseGeometry(geometry);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  _mm_setcsr(_mm_getcsr() & ~0x8040u);
}

template <Shape kShape>
void embree_low(benchmark::State& state) {
  embree<kShape>(state, RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_LOW);
}
template <Shape kShape>
void embree_refit(benchmark::State& state) {
  embree<kShape>(state, RTC_BUILD_QUALITY_REFIT, RTC_BUILD_QUALITY_LOW);
}
template <Shape kShape>
void embree_medium(benchmark::State& state) {
  embree<kShape>(state, RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_MEDIUM);
}

#endif

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"kilo", "threads"})->Args({66, 2})->Args({1000, 2});
  const char* large = std::getenv("RAYSHEAF_BENCH_LARGE");
  if (large != nullptr && *large == '1') bench->Args({10000, 2});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(rebuild<kGrid>)->Apply(sizes);
BENCHMARK(rebuild<kSoup>)->Apply(sizes);
BENCHMARK(coarse<kGrid>)->Apply(sizes);
BENCHMARK(coarse<kSoup>)->Apply(sizes);
#ifdef RAYSHEAF_BENCH_EMBREE
BENCHMARK(embree_low<kGrid>)->Apply(sizes);
BENCHMARK(embree_low<kSoup>)->Apply(sizes);
#endif
BENCHMARK(refit<kGrid>)->Apply(sizes);
BENCHMARK(refit<kSoup>)->Apply(sizes);
#ifdef RAYSHEAF_BENCH_EMBREE
BENCHMARK(embree_refit<kGrid>)->Apply(sizes);
BENCHMARK(embree_refit<kSoup>)->Apply(sizes);
#endif
BENCHMARK(fine<kGrid>)->Apply(sizes);
BENCHMARK(fine<kSoup>)->Apply(sizes);
#ifdef RAYSHEAF_BENCH_EMBREE
BENCHMARK(embree_medium<kGrid>)->Apply(sizes);
BENCHMARK(embree_medium<kSoup>)->Apply(sizes);
#endif

}  // namespace
}  // namespace raysheaf::bench
