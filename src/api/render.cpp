// render(): checks what the caller hands in, prepares the scene, runs a frame. The one place where
// errors of the layers below become `Error`.
#include "raysheaf/render_on_context.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <new>
#include <optional>

#include "api/context_impl.h"
#include "exec/executor.h"
#include "frame/frame.h"
#include "frame/stopwatch.h"
#include "raster/rasterizer.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kLargestSide = 16384;
constexpr std::uint32_t kMostBounces = 32, kMostLevels = 8, kMostBranching = 64,
                        kMostThreads = 1024;
/// What a frame needs a pixel, with room for a batch of secondary rays beside the primary
/// fragments.
constexpr std::uint64_t kBytesPerPixel = 640;

void check_range(const char* option, std::uint32_t value, std::uint32_t least, std::uint32_t most) {
  if (value < least || value > most)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from " + std::to_string(least) + " to " + std::to_string(most) + ", not " +
                    std::to_string(value),
                option);
}

void check_memory(const RenderOptions& options) {
  const std::uint64_t needed = std::uint64_t{options.width} * options.height * kBytesPerPixel;
  const auto pages = static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PHYS_PAGES)));
  const auto page_bytes = static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PAGESIZE)));
  if (pages * page_bytes != 0 && needed > pages * page_bytes)
    throw Error(ErrorCode::kOutOfMemory,
                "a picture of this size needs about " + std::to_string(needed >> 30) +
                    " GiB, more than this machine has",
                "size");
}

void check(const RenderOptions& options) {
  check_range("width", options.width, 1, kLargestSide);
  check_range("height", options.height, 1, kLargestSide);
  check_range("bounces", options.bounces, 0, kMostBounces);
  check_range("levels", options.levels, 1, kMostLevels);
  check_range("branching", options.branching, 2, kMostBranching);
  if (options.key_bits && *options.key_bits != 32 && *options.key_bits != 64)
    throw Error(ErrorCode::kInvalidArgument, "must be 32 or 64", "key_bits");
  check_range("threads", options.threads, 0, kMostThreads);
  if (options.exposure && !(*options.exposure > 0 && std::isfinite(*options.exposure)))
    throw Error(ErrorCode::kInvalidArgument, "must be a positive number", "exposure");
  if (options.ambient && !(is_finite(*options.ambient) && min_component(*options.ambient) >= 0))
    throw Error(ErrorCode::kInvalidArgument, "must be finite and not negative", "ambient");
  check_memory(options);
}

/// What a device does not know.
void check_for_device(const RenderOptions& options) {
  const auto refuse = [](const char* sentence, const char* option) {
    throw Error(ErrorCode::kUnsupported, sentence, option);
  };
  if (options.method == Method::kGl10) refuse("gl10 does not run on a CUDA device", "method");
  if (options.method != Method::kRah && options.method != Method::kCrsh) return;
  const RayKey key = options.key.value_or(RayKey::kCrsh);
  if (key != RayKey::kCrsh && key != RayKey::kRaster)
    refuse("a CUDA device sorts rays by the key crsh, or leaves them in raster order", "key");
  if (options.bound.value_or(BundleBound::kSphereCone) != BundleBound::kSphereCone)
    refuse("a CUDA device bounds rays by sphere-cone alone", "bound");
  if (options.count_pixel_tests)
    refuse(
        "rah and crsh do not count the tests of pixels on a CUDA device, which heat maps and "
        "OpenEXR show",
        "tests");
}

std::string camera_names(const SceneDescription& scene) {
  std::string names;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    names += (i == 0 ? "" : ", ") + std::to_string(i);
    if (!scene.cameras[i].name.empty()) names += " \"" + scene.cameras[i].name + "\"";
  }
  return names.empty() ? "none of its own" : names;
}

/// By name, then by index; the first where nothing is asked for, or one that frames the scene.
Camera find_camera(const SceneDescription& scene, const std::string& wanted) {
  if (wanted.empty()) return scene.cameras.empty() ? framing_camera(scene) : scene.cameras.front();
  for (const Camera& camera : scene.cameras)
    if (camera.name == wanted) return camera;
  std::size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, error] = std::from_chars(wanted.data(), end, index);
  if (error == std::errc{} && stop == end && index < scene.cameras.size())
    return scene.cameras[index];
  throw Error(ErrorCode::kNotFound,
              "the scene has no camera \"" + wanted + "\"; it has " + camera_names(scene),
              "camera");
}

std::vector<Light> find_lights(const SceneDescription& scene, const Camera& camera) {
  if (needs_light(scene)) return {showing_light(scene, camera)};
  return scene.lights;
}

RenderResult render_checked(const Executor& executor, const DeviceBackend* backend,
                            const SceneDescription& scene, const RenderOptions& options) {
  Stopwatch watch;
  ProgressMeter meter(options.progress);
  const Camera camera = find_camera(scene, options.camera);
  const std::vector<Light> lights = find_lights(scene, camera);
  std::optional<Rasterizer> rasterizer;
  if (options.primary == Primary::kRaster) rasterizer.emplace();

  meter.begin("scene", 1);
  const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
  const TextureSet textures(scene);
  const FrameInput input{
      flat, textures, camera, lights, options, rasterizer ? &*rasterizer : nullptr, backend};
  RenderResult result = render_frame(executor, input, &meter);

  FrameStatistics& s = result.statistics;
  s.scene = scene.name;
  s.triangles = flat.triangle_count;
  s.meshes = flat.meshes.size();
  s.width = options.width;
  s.height = options.height;
  s.method = to_string(options.method);
  s.device = to_string(backend != nullptr ? Device::kCuda : Device::kCpu);
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
    return render_checked(Executor(options.threads), nullptr, scene, options);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory for this picture");
  }
}

RenderResult render(const Context& context, const SceneDescription& scene,
                    const RenderOptions& options) {
  const DeviceBackend* const backend = ContextAccess::backend(context);
  try {
    check(options);
    if (backend != nullptr) check_for_device(options);
    validate(scene);
    return render_checked(ContextAccess::executor(context), backend, scene, options);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory for this picture");
  }
}

}  // namespace raysheaf
