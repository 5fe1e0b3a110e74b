// The input of the stage benchmarks: a scene, its primary hits, and its shadow rays.
//
// The scene is the built-in atrium, or the file or built-in scene in RAYSHEAF_BENCH_SCENE. It is
// prepared once per program, outside every timed loop.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "exec/executor.h"
#include "rays/order/order.h"
#include "rays/raygen.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "render/frame/primary.h"
#include "render/raster/rasterizer.h"
#include "scene/flat_arrays.h"
#include "surface/texture.h"

namespace raysheaf::bench {

inline constexpr PictureSize kSize{512, 512};

inline SceneDescription bench_scene() {
  const char* asked = std::getenv("RAYSHEAF_BENCH_SCENE");
  const std::string name = asked != nullptr && *asked != '\0' ? asked : "builtin:atrium";
  const std::string builtin = "builtin:";
  SceneDescription scene = name.compare(0, builtin.size(), builtin) == 0
                               ? builtin_scene(name.substr(builtin.size()))
                               : load_scene(name);
  add_missing_camera_and_light(scene);
  return scene;
}

/// Rasterised, or traced if OpenGL is not available.
inline std::vector<std::uint32_t> first_hits(const Executor& executor, const FlatScene& flat,
                                             const CameraFrame& frame) {
  try {
    Rasterizer rasterizer;
    return rasterize_primary(executor, rasterizer, flat, frame);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNoGraphics) throw;
  }
  BatchStatistics statistics;
  ProgressMeter meter;
  return trace_primary(executor, flat, frame, method_settings(Method::kCrsh), &statistics, {},
                       &meter);
}

struct Input {
  Input() : fragments(fragments_at(Executor(), kSize)) {}
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  [[nodiscard]] Fragments fragments_at(const Executor& executor, PictureSize size) const {
    const CameraFrame frame = make_camera_frame(scene.cameras.front(), size.width, size.height);
    return fetch_fragments(executor, flat, textures, frame, first_hits(executor, flat, frame));
  }
  [[nodiscard]] RayBatch shadow_rays(const Executor& executor,
                                     View<const Fragment> of_fragments) const {
    return make_shadow_rays(executor, of_fragments, placed_lights(scene.lights), 0,
                            static_cast<std::uint32_t>(scene.lights.size()), flat.bounds);
  }

  SceneDescription scene = bench_scene();
  TextureSet textures{scene};
  FlatScene flat = flatten(Executor(), scene, mesh_bounds(Executor(), scene));
  FlatArrays arrays{Executor(), flat};
  Fragments fragments;  ///< one per pixel of kSize
};

inline const Input& input() {
  static const Input the_input;
  return the_input;
}

/// The shadow rays in the order of their keys (`crsh`), or in the original order (`rah`).
inline std::vector<Ray> ordered_shadow_rays(bool sorted) {
  const Executor executor;
  const RayBatch batch = input().shadow_rays(executor, input().fragments);
  if (!sorted) return {batch.rays.begin(), batch.rays.end()};
  std::vector<std::uint32_t> order(batch.rays.size());
  order_by_key(executor, batch.keys, order, batch.key_bits);
  std::vector<Ray> rays;
  for (const std::uint32_t ray : order) rays.push_back(batch.rays[ray]);
  return rays;
}

/// `state.range(place)` is the number of threads; 0 stands for all cores.
inline Executor executor_of(const benchmark::State& state, int place) {
  return Executor(static_cast<std::uint32_t>(state.range(static_cast<std::size_t>(place))));
}

inline void count_items(benchmark::State& state, std::size_t items_an_iteration) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items_an_iteration));
}

/// Seconds of wall time for each of `count` steps per iteration.
inline benchmark::Counter time_each(double count) {
  return {count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

}  // namespace raysheaf::bench
