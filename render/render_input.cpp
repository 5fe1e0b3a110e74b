// Options of a frame, and the camera and lights that they select.
#include "render/render_input.h"

#include <algorithm>
#include <cmath>

#include "api/scene/context_impl.h"
#include "base/vec.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/studio.h"
#include "render/frame/ranges.h"
#include "system/process.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kMostBounces = 32, kMostSamples = 65536;

void check_length(const char* option, const std::optional<float>& value) {
  if (value && !(*value >= 0 && std::isfinite(*value)))
    throw Error(ErrorCode::kInvalidArgument, "must be a number, 0 or more", option);
}

void check_memory(const RenderOptions& options) {
  const std::uint64_t bytes = kBytesPerPixel + (options.gbuffer ? kGbufferBytesPerPixel : 0);
  const std::uint64_t needed = std::uint64_t{options.width} * options.height * bytes;
  const std::uint64_t room = system::memory_bytes();
  if (room != 0 && needed > room)
    throw Error(ErrorCode::kOutOfMemory,
                "an image of this size needs about " + std::to_string(needed >> 30) +
                    " GiB, more than this machine has",
                "size");
}

}  // namespace

void set_default_size(const Camera& camera, RenderOptions* options) {
  const DefaultSize size = default_size(camera);
  options->width = size.width;
  options->height = size.height;
}

void check(const RenderOptions& options) {
  check_range("width", options.width, 1, kLargestSide);
  check_range("height", options.height, 1, kLargestSide);
  check_range("bounces", options.bounces, 0, kMostBounces);
  check_range("samples", options.samples, 0, kMostSamples);
  check_length("aperture", options.aperture);
  check_length("focus", options.focus);
  check_hierarchy(options.levels, options.branching, options.key_bits);
  check_range("threads", options.threads, 0, kMostThreads);
  if (options.exposure && !(*options.exposure > 0 && std::isfinite(*options.exposure)))
    throw Error(ErrorCode::kInvalidArgument, "must be a positive number", "exposure");
  if (options.ambient && !(is_finite(*options.ambient) && min_component(*options.ambient) >= 0))
    throw Error(ErrorCode::kInvalidArgument, "must be finite and not negative", "ambient");
  if (options.gbuffer && options.primary != Primary::kRaster)
    throw Error(ErrorCode::kInvalidArgument,
                "OpenGL draws the targets, but rays are asked for to find primary visibility",
                "gbuffer");
  if (options.ground && options.ground->height && !std::isfinite(*options.ground->height))
    throw Error(ErrorCode::kInvalidArgument, "its height must be finite", "ground");
  check_memory(options);
}

std::vector<PlacedLight> find_lights(const SceneDescription& scene, const Camera& camera,
                                     std::uint32_t samples) {
  std::vector<PlacedLight> lights =
      placed_lights(needs_light(scene) ? studio_lights(scene, camera) : scene.lights);
  if (samples > 1) return lights;
  for (PlacedLight& light : lights) light.radius = 0;
  return lights;
}

StudioRoom find_room(const SceneDescription& scene, const Camera& camera,
                     const RenderOptions& options) {
  if (!options.soft_boxes) return {};
  if (needs_light(scene)) return studio_room(studio_lights(scene, camera));
  return has_studio_lights(scene) ? studio_room(scene.lights) : StudioRoom{};
}

std::uint32_t find_samples(const SceneDescription& scene, const Camera& camera,
                           const RenderOptions& options) {
  constexpr std::uint32_t kOfAChance = 16, kOfAStudio = 4;
  if (options.samples > 0) return options.samples;
  if (!scene.environment.empty() || camera.aperture > 0) return kOfAChance;
  return needs_light(scene) || has_studio_lights(scene) ? kOfAStudio : 1;
}

}  // namespace raysheaf
