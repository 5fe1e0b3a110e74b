// Calls with few rays, compared with a loop of Embree's single rays: what a call costs in addition
// to its rays. Arguments: rays a call, coherent (0 or 1). `threads:2` are two callers. Embree is
// found as by `raysheaf bench compare`; without it only the library is measured.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "lab/commands/compare/calls.h"
#include "lab/commands/compare/embree_library.h"
#include "raysheaf/query.h"

namespace raysheaf::bench {
namespace {

/// A bumpy sphere of 100 352 triangles.
constexpr std::uint32_t kRings = 224;

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

Mesh make_sphere() {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= kRings; ++y) {
    for (std::uint32_t x = 0; x <= kRings; ++x) {
      const float u = 2 * std::numbers::pi_v<float> * static_cast<float>(x) / kRings;
      const float v = std::numbers::pi_v<float> * static_cast<float>(y) / kRings;
      const float r = 1 + 0.05f * std::sin(9 * u) * std::sin(11 * v);
      mesh.positions.push_back(
          {r * std::sin(v) * std::cos(u), r * std::sin(v) * std::sin(u), r * std::cos(v)});
    }
  }
  for (std::uint32_t y = 0; y < kRings; ++y) {
    for (std::uint32_t x = 0; x < kRings; ++x) {
      const std::uint32_t a = y * (kRings + 1) + x, b = a + kRings + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

/// So many that no processor learns them.
constexpr std::size_t kSide = 256, kRays = kSide * kSide;

/// From anywhere in the box around the sphere, in any direction.
std::vector<Ray> make_random() {
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> box(-1.1f, 1.1f);
  std::normal_distribution<float> any;
  std::vector<Ray> rays(kRays);
  for (Ray& ray : rays)
    ray = {{box(engine), box(engine), box(engine)}, 0, {any(engine), any(engine), any(engine)}};
  return rays;
}

/// An image of the sphere, row after row.
std::vector<Ray> make_image() {
  std::vector<Ray> rays;
  for (std::size_t y = 0; y < kSide; ++y) {
    for (std::size_t x = 0; x < kSide; ++x) {
      const auto at = [](std::size_t i) { return 2 * (static_cast<float>(i) + 0.5f) / kSide - 1; };
      rays.push_back({{0, 0, 3}, 0, {0.36f * at(x), 0.36f * at(y), -1}});
    }
  }
  return rays;
}

/// The scene on both sides, and the rays.
class Sides {
 public:
  Sides() : mesh_(make_sphere()) {
    scene.add(mesh_.positions, mesh_.triangles);
    scene.commit();
    // So many that the tree has been built finely, as that of Embree is.
    std::vector<Hit> hits(kRays);
    for (int i = 0; i < 60; ++i) closest_hit(scene, rays[0], hits);
    try {
      library_ = app::find_embree().front();
    } catch (const Error&) {
      return;
    }
    app::embree::Api& api = library_->api;
    const app::embree::Device device = api.new_device("threads=1");
    api.major_version = static_cast<int>(
        api.device_property(device, app::embree::DeviceProperty::kVersion) / 10'000);
    peer_ = api.new_scene(device);
    api.set_scene_quality(peer_, app::embree::Quality::kHigh);
    const app::embree::Geometry geometry =
        api.new_geometry(device, app::embree::GeometryType::kTriangle);
    api.set_geometry_quality(geometry, app::embree::Quality::kHigh);
    mesh_.positions.push_back({});  // Embree reads four bytes more
    api.share_buffer(geometry, app::embree::Buffer::kVertex, 0, app::embree::Format::kFloat3,
                     mesh_.positions.data(), 0, sizeof(Vec3), mesh_.positions.size() - 1);
    api.share_buffer(geometry, app::embree::Buffer::kIndex, 0, app::embree::Format::kUint3,
                     mesh_.triangles.data(), 0, sizeof(Triangle), mesh_.triangles.size());
    api.commit_geometry(geometry);
    api.attach(peer_, geometry, 0);
    api.commit_scene(peer_);
  }

  [[nodiscard]] bool has_peer() const { return library_.has_value(); }
  [[nodiscard]] app::EmbreeQuestion question() const { return {library_->api, peer_, false}; }

  const std::vector<Ray> rays[2] = {make_random(), make_image()};
  Scene scene;

 private:
  Mesh mesh_;
  std::optional<app::EmbreeLibrary> library_;
  app::embree::Scene peer_ = nullptr;
};

const Sides& sides() {
  static const Sides kSides;
  return kSides;
}

/// Calls `ask(rays, hits)` for one piece of the rays after the other.
template <class Ask>
void time_calls(benchmark::State& state, const Ask& ask) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const std::vector<Ray>& rays = sides().rays[state.range(1)];
  std::vector<Hit> hits(count);
  std::size_t at = kRays / static_cast<std::size_t>(state.threads()) *
                   static_cast<std::size_t>(state.thread_index());
  for (auto _ : state) {
    ask(std::span(rays).subspan(at, count), std::span(hits));
    benchmark::DoNotOptimize(hits.data());
    at += count;
    if (at + count > kRays) at = 0;
  }
  using benchmark::Counter;
  state.counters["per_ray"] =
      Counter(static_cast<double>(count), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void by_raysheaf(benchmark::State& state) {
  time_calls(state, [](std::span<const Ray> rays, std::span<Hit> hits) {
    closest_hit(sides().scene, rays, hits);
  });
}

void by_single_calls(benchmark::State& state) {
  time_calls(state, [](std::span<const Ray> rays, std::span<Hit> hits) {
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = closest_hit(sides().scene, rays[i]);
  });
}

void by_embree(benchmark::State& state) {
  if (!sides().has_peer()) return state.SkipWithError("there is no Embree");
  app::EmbreeQuestion question = sides().question();
  time_calls(state, [&](std::span<const Ray> rays, std::span<Hit> hits) {
    app::embree_calls().front().closest(question, rays, hits);
  });
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"rays", "coherent"});
  for (const int coherent : {0, 1})
    for (const int rays : {1, 10, 100, 1000}) bench->Args({rays, coherent});
}
BENCHMARK(by_raysheaf)->Apply(sizes);
BENCHMARK(by_single_calls)->ArgNames({"rays", "coherent"})->Args({1, 0})->Args({1, 1});
BENCHMARK(by_embree)->Apply(sizes);
BENCHMARK(by_raysheaf)->Apply(sizes)->Threads(2)->UseRealTime();
BENCHMARK(by_embree)->Apply(sizes)->Threads(2)->UseRealTime();

}  // namespace
}  // namespace raysheaf::bench
