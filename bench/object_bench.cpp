// The object tree: rebuilt along a curve, also coarsely, refitted, built finely.
// Arguments: thousands of triangles, threads. RAYSHEAF_BENCH_LARGE=1 adds ten million.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "object_tree/object_tree.h"

namespace raysheaf::bench {
namespace {

using Index = std::array<std::uint32_t, 3>;

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
BENCHMARK(refit<kGrid>)->Apply(sizes);
BENCHMARK(refit<kSoup>)->Apply(sizes);
BENCHMARK(fine<kGrid>)->Apply(sizes);
BENCHMARK(fine<kSoup>)->Apply(sizes);

}  // namespace
}  // namespace raysheaf::bench
