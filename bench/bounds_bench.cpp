// The node test of each bound, as the SIMD kernel and as one call per triangle: nanoseconds per
// test, and the fraction of triangles that pass. Bundles have 64 rays from one point to a patch of
// the scene.
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "base/aligned.h"
#include "geom/bounds.h"
#include "methods/ray_hierarchy/node_test.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kTriangles = 8192;
constexpr std::size_t kNodes = 32;
const Box kScene{{-10, -10, -10}, {11, 11, 11}};

class Draws {
 public:
  Vec3 in_box(float half) { return {at(half), at(half), at(half)}; }

 private:
  float at(float half) { return std::uniform_real_distribution<float>(-half, half)(random_); }
  std::mt19937 random_{7};
};

struct Triangles {
  AlignedVector<float> vertex[3][3], sphere[4];

  explicit Triangles(Draws& draws) {
    for (std::uint32_t i = 0; i < kTriangles; ++i) {
      const Vec3 a = draws.in_box(10);
      const Vec3 corners[3] = {a, a + draws.in_box(0.5f), a + draws.in_box(0.5f)};
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis) vertex[k][axis].push_back(component(corners[k], axis));
      const Sphere ball = triangle_sphere(corners[0], corners[1], corners[2]);
      sphere[0].push_back(ball.center.x), sphere[1].push_back(ball.center.y);
      sphere[2].push_back(ball.center.z), sphere[3].push_back(ball.radius);
    }
  }

  [[nodiscard]] TriangleView view() const {
    TriangleView v;
    v.count = kTriangles;
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) v.vertex[k][axis] = vertex[k][axis].data();
    for (int field = 0; field < 4; ++field) v.sphere[field] = sphere[field].data();
    return v;
  }
};

template <class Bound>
std::vector<NodeTest<Bound>> random_nodes(Draws& draws) {
  std::vector<NodeTest<Bound>> tests;
  for (std::size_t n = 0; n < kNodes; ++n) {
    const Vec3 origin = draws.in_box(9), patch = draws.in_box(9);
    std::vector<Ray> rays;
    for (int i = 0; i < 64; ++i) rays.push_back({origin, 0, patch + draws.in_box(1) - origin, 1});
    Bound bound;
    bound_rays(rays, kScene, &bound);
    tests.push_back(make_node_test(bound));
  }
  return tests;
}

/// `run`: triangles per call; a run of 1 uses the scalar test.
template <class Bound>
void node_test(benchmark::State& state) {
  Draws draws;
  const Triangles triangles(draws);
  const auto nodes = random_nodes<Bound>(draws);
  const auto fields = fields_of<NodeTest<Bound>>(triangles.view());
  const auto run = static_cast<std::uint32_t>(state.range(0));
  std::vector<std::uint32_t> out(kTriangles + 16);
  std::uint64_t met = 0;
  for (auto _ : state) {
    met = 0;
    for (const auto& node : nodes)
      for (std::uint32_t i = 0; i + run <= kTriangles; i += run)
        met += filter(node, from(fields, i), run, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  constexpr double kTests = double{kNodes} * kTriangles;
  state.counters["per_test"] = benchmark::Counter(
      kTests, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["part_met"] = static_cast<double>(met) / kTests;
}

void runs(benchmark::internal::Benchmark* bench) {
  bench->ArgName("run")->Arg(1024)->Arg(1)->Unit(benchmark::kMicrosecond);
}

BENCHMARK(node_test<RayBound>)->Apply(runs);
BENCHMARK(node_test<FiniteCone>)->Apply(runs);
BENCHMARK(node_test<Shaft>)->Apply(runs);
BENCHMARK(node_test<Frustum>)->Apply(runs);
BENCHMARK(node_test<ShaftCone>)->Apply(runs);

}  // namespace
}  // namespace raysheaf
