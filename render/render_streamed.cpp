// render() of a streamed scene.
#include <algorithm>
#include <optional>
#include <string>

#include "api/scene/context_impl.h"
#include "exec/stopwatch.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/stream.h"
#include "raysheaf/studio.h"
#include "render/frame/frame.h"
#include "render/frame/ground.h"
#include "render/geometry/streamed_geometry.h"
#include "render/render_input.h"
#include "render/surface/environment.h"
#include "render/surface/texture.h"

namespace raysheaf {
namespace {

/// The process's memory in addition to the image and the blocks.
constexpr std::uint64_t kFrameBaseBytes = std::uint64_t{48} << 20;
/// The caller's, and that of `EnvironmentMap`.
constexpr std::uint64_t kBytesPerTexelOfSky = sizeof(Vec3) + sizeof(float);
constexpr std::uint64_t kBytesPerShadowRay = 128 + kStreamRayBytes;

void refuse(const std::string& sentence, const char* option) {
  throw Error(ErrorCode::kUnsupported, sentence, option);
}

void check_streamed(const RenderOptions& options, const StreamOptions& stream) {
  if (options.method != Method::kDual) refuse("streaming supports only the method dual", "method");
  if (options.primary != Primary::kTrace)
    refuse("streaming finds primary hits only by trace", "primary");
  check_parts(stream);
}

/// The scene's lights. None is added here: `cut_into_blocks` adds one to a scene that needs it.
std::vector<PlacedLight> lights_of(const SceneDescription& scene, std::uint32_t samples) {
  if (scene.lights.empty()) return {};
  return find_lights(scene, scene.cameras.front(), samples);
}

RenderResult render_checked(const GeometrySource& source, const RenderOptions& options,
                            const StreamOptions& stream) {
  Stopwatch watch;
  const Context context =
      stream.context != nullptr ? *stream.context : Context({.threads = options.threads});
  const Executor& executor = ContextAccess::executor(context);
  const SceneDescription& scene = source.scene();
  Camera camera = find_camera(scene, options.camera);
  camera.aperture = options.aperture.value_or(camera.aperture);
  camera.focus = options.focus.value_or(camera.focus);
  const std::uint32_t samples = find_samples(scene, camera, options);
  const std::vector<PlacedLight> lights = lights_of(scene, samples);
  const TextureSet textures(scene);
  const EnvironmentMap environment(executor, scene.environment);

  const std::uint64_t pixels = std::uint64_t{options.width} * options.height;
  const std::uint64_t sky = scene.environment.radiance.size() * kBytesPerTexelOfSky;
  const std::uint64_t taken = kFrameBaseBytes + sky + pixels * (kBytesPerPixel + kStreamRayBytes);
  const std::uint32_t slots = slots_for(stream.memory_bytes, taken, pixels);
  const std::uint64_t room = (stream.memory_bytes - taken) / 4;
  Streamer streamer(executor, source, stream, slots, ContextAccess::backend(context));
  StreamedGeometry geometry(executor, &streamer, textures,
                            std::max(pixels, room / kBytesPerShadowRay));
  const auto complete = [&](FrameStatistics* s) {
    s->scene = scene.name;
    s->triangles = streamer.triangle_count();
    s->meshes = scene.instances.size();
    s->width = options.width;
    s->height = options.height;
    s->method = to_string(options.method);
    s->device = to_string(context.device());
    s->primary = "trace";
    s->threads = executor.threads();
    s->total_ms = watch.ms();
  };
  FrameInput input{geometry,
                   camera,
                   lights,
                   options,
                   samples,
                   nullptr,
                   scene.environment.empty() ? nullptr : &environment.view(),
                   complete};
  if (has_studio_lights(scene)) input.room = find_room(scene, camera, options);
  std::optional<Ground> ground;
  if (options.ground) ground = placed_ground(*options.ground, streamer.bounds());
  RenderResult result = render_frame(executor, input);
  if (ground) {
    const RenderOptions lit = ground_options(options, result);
    FrameInput ground_input{geometry, camera, lights, lit, samples};
    ground_input.environment = input.environment;
    add_ground(executor, ground_input, *ground, &result);
    result.statistics.total_ms = watch.ms();
  }

  StreamStatistics statistics = streamer.statistics();
  add(geometry.shading(), &statistics);
  statistics = of_all(statistics, stream.exchange);
  if (stream.statistics != nullptr) add(statistics, stream.statistics);
  return result;
}

}  // namespace

RenderResult render(const GeometrySource& source, const RenderOptions& wanted,
                    const StreamOptions& stream) {
  return within_memory("there is not enough memory for this image", "", [&] {
    RenderOptions options = wanted;
    if (options.width == 0 && options.height == 0)
      set_default_size(find_camera(source.scene(), options.camera), &options);
    check(options);
    check_streamed(options, stream);
    validate_but_triangles(source.scene());
    if (source.scene().cameras.empty())
      throw Error(ErrorCode::kInvalidData, "a streamed scene needs a camera", "cameras");
    return render_checked(source, options, stream);
  });
}

}  // namespace raysheaf
