// render(): checks what the caller hands in, prepares the scene, runs a frame. The one place where
// errors of the layers below become `Error`.
#include "raysheaf/render.h"

#include <new>
#include <optional>

#include "api/render_input.h"
#include "exec/executor.h"
#include "exec/stopwatch.h"
#include "frame/frame.h"
#include "frame/resident_geometry.h"
#include "raster/rasterizer.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

RenderResult render_checked(const SceneDescription& scene, const RenderOptions& options) {
  Stopwatch watch;
  const Executor executor(options.threads);
  ProgressMeter meter(options.progress);
  const Camera camera = find_camera(scene, options.camera);
  const std::vector<Light> lights = find_lights(scene, camera);
  std::optional<Rasterizer> rasterizer;
  if (options.primary == Primary::kRaster) rasterizer.emplace();

  meter.begin("scene", 1);
  const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
  const TextureSet textures(scene);
  ResidentGeometry geometry(executor, flat, textures, settings_for(options));
  const FrameInput input{geometry, camera, lights, options, rasterizer ? &*rasterizer : nullptr};
  RenderResult result = render_frame(executor, input, &meter);

  FrameStatistics& s = result.statistics;
  s.scene = scene.name;
  s.triangles = flat.triangle_count;
  s.meshes = flat.meshes.size();
  s.width = options.width;
  s.height = options.height;
  s.method = to_string(options.method);
  s.device = "cpu";
  s.primary = rasterizer ? "raster: " + rasterizer->description() : "trace";
  s.threads = executor.threads();
  s.total_ms = watch.lap_ms();
  return result;
}

}  // namespace

RenderResult render(const SceneDescription& scene, const RenderOptions& options) {
  try {
    check(options);
    validate(scene);
    return render_checked(scene, options);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory for this picture");
  }
}

}  // namespace raysheaf
