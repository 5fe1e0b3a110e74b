// Primary visibility: a bumpy sphere and a soup of about 66 000 triangles, 512 x 512.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <random>

#include "exec/executor.h"
#include "raysheaf/error.h"
#include "render/raster/pack.h"
#include "render/raster/rasterizer.h"
#include "render/raster/resolve.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kSize = 512;

/// A flat scene of one mesh, made triangle by triangle.
struct MadeScene : FlatScene {
  std::vector<Vec3> corners_in_order;  ///< three a triangle
};

void add(MadeScene& scene, Vec3 a, Vec3 b, Vec3 c, std::uint8_t flags) {
  for (const Vec3 corner : {a, b, c}) {
    scene.corners_in_order.push_back(corner);
    scene.bounds.min = min(scene.bounds.min, corner);
    scene.bounds.max = max(scene.bounds.max, corner);
  }
  scene.flags.push_back(flags);
  scene.mesh_of_triangle.push_back(0);
  PlacedInstance all;
  all.positions = View<const Vec3>(scene.corners_in_order);
  all.triangle_count = ++scene.triangle_count;
  scene.placed.list({all});
}

MadeScene sphere(std::uint8_t flags) {
  constexpr int kRows = 182, kColumns = 182;
  const auto point = [](int row, int column) {
    const float theta = 3.14159265f * static_cast<float>(row) / kRows;
    const float phi = 6.28318531f * static_cast<float>(column % kColumns) / kColumns;
    const float r = 1 + 0.05f * std::sin(9 * theta) * std::cos(8 * phi);
    return Vec3{r * std::sin(theta) * std::cos(phi), r * std::cos(theta),
                -r * std::sin(theta) * std::sin(phi)};
  };
  MadeScene scene;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Vec3 a = point(row, column), b = point(row + 1, column);
      const Vec3 c = point(row + 1, column + 1), d = point(row, column + 1);
      add(scene, a, b, c, flags);
      add(scene, a, c, d, flags);
    }
  }
  return scene;
}

MadeScene soup(std::uint8_t flags) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> any(-1, 1), small(-0.03f, 0.03f);
  MadeScene scene;
  for (int i = 0; i < 66000; ++i) {
    const Vec3 a{any(engine), any(engine), any(engine)};
    add(scene, a, a + Vec3{small(engine), small(engine), small(engine)},
        a + Vec3{small(engine), small(engine), small(engine)}, flags);
  }
  return scene;
}

MadeScene scene_of(const benchmark::State& state) {
  const auto flags = static_cast<std::uint8_t>(state.range(1) != 0 ? kSingleSided : 0);
  return state.range(0) == 0 ? sphere(flags) : soup(flags);
}

Camera camera() {
  Camera camera;
  camera.to_world = look_at({0, 0.4f, 2.4f}, {}, {0, 1, 0});
  return camera;
}

std::unique_ptr<Rasterizer> rasterizer_or_skip(benchmark::State& state) {
  try {
    auto rasterizer = std::make_unique<Rasterizer>();
    state.SetLabel(rasterizer->description());
    return rasterizer;
  } catch (const Error& error) {
    state.SkipWithError(error.what());
    return nullptr;
  }
}

void visible_triangles(benchmark::State& state) {
  const MadeScene scene = scene_of(state);
  const auto rasterizer = rasterizer_or_skip(state);
  const Executor executor;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        rasterizer->visible_triangles(executor, scene, make_camera_frame(camera(), kSize, kSize)));
  }
}

void resolve(benchmark::State& state) {
  const MadeScene scene = scene_of(state);
  const auto rasterizer = rasterizer_or_skip(state);
  if (rasterizer == nullptr) return;
  const Executor executor;
  const auto drawn =
      rasterizer->visible_triangles(executor, scene, make_camera_frame(camera(), kSize, kSize));
  for (auto _ : state) {
    auto picture = drawn;
    resolve_silhouettes(executor, scene, make_camera_frame(camera(), kSize, kSize), picture);
    benchmark::DoNotOptimize(picture.data());
  }
}

void pack(benchmark::State& state) {
  const MadeScene scene = scene_of(state);
  const Executor executor;
  const CameraFrame frame = make_camera_frame(camera(), kSize, kSize);
  const PictureView view = make_picture_view(frame, scene.bounds);
  TrianglePacker packer;
  std::vector<float> corners(std::size_t{scene.triangle_count} * kFloatsPerTriangle);
  std::vector<std::uint32_t> numbers(scene.triangle_count);
  std::uint32_t kept = 0;
  for (auto _ : state) {
    kept = packer.choose(executor, scene, view, 0, scene.triangle_count);
    packer.pack(executor, scene, view, corners.data(), numbers.data());
  }
  state.counters["triangles"] = scene.triangle_count;
  state.counters["kept"] = kept;
}

const std::vector<std::vector<std::int64_t>> kScenes = {{0, 1}, {0, 1}};

BENCHMARK(visible_triangles)
    ->ArgNames({"soup", "single_sided"})
    ->ArgsProduct(kScenes)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(resolve)
    ->ArgNames({"soup", "single_sided"})
    ->ArgsProduct(kScenes)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(pack)
    ->ArgNames({"soup", "single_sided"})
    ->ArgsProduct(kScenes)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace raysheaf
