// Validates and completes the options of a frame.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/render.h"
#include "render/rays/light_body.h"
#include "render/surface/studio_room.h"

namespace raysheaf {

/// The memory of a frame per pixel, including a batch of secondary rays in addition to the primary
/// fragments.
inline constexpr std::uint64_t kBytesPerPixel = 640;
/// OpenGL's, the renderer's and the result's.
inline constexpr std::uint64_t kGbufferBytesPerPixel = 3 * 64;

/// Throws `Error` naming the first option that is out of range.
void check(const RenderOptions& options);
/// `default_size` of the camera.
void set_default_size(const Camera& camera, RenderOptions* options);

/// The scene's lights, or one that illuminates what the camera sees. With a single sample, spheres
/// emit light from their centres, because there is nothing to sample.
[[nodiscard]] std::vector<PlacedLight> find_lights(const SceneDescription& scene,
                                                   const Camera& camera, std::uint32_t samples);

/// The room that reflections and refractions show if the lights are the studio's, unless the
/// options or an environment exclude it.
[[nodiscard]] StudioRoom find_room(const SceneDescription& scene, const Camera& camera,
                                   const RenderOptions& options);

/// The requested number, or the default for the scene's lights and the lens.
[[nodiscard]] std::uint32_t find_samples(const SceneDescription& scene, const Camera& camera,
                                         const RenderOptions& options);

}  // namespace raysheaf
