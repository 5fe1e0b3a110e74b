// What a caller asks of a frame, looked over.
#pragma once

#include <cstdint>
#include <vector>

#include "rays/light_body.h"
#include "raysheaf/render.h"

namespace raysheaf {

/// What a frame needs a pixel, with room for a batch of secondary rays beside the primary
/// fragments.
inline constexpr std::uint64_t kBytesPerPixel = 640;

/// Throws `Error` that names the first option which is out of range.
void check(const RenderOptions& options);
/// `default_size` of the camera.
void set_default_size(const Camera& camera, RenderOptions* options);

/// The scene's, or one that shows it from where the camera stands. Where there is but one sample,
/// balls shine from their centres: there is no choice to be made.
[[nodiscard]] std::vector<PlacedLight> find_lights(const SceneDescription& scene,
                                                   const Camera& camera, std::uint32_t samples);

/// Those asked for, or as many as the scene's light and the lens want.
[[nodiscard]] std::uint32_t find_samples(const SceneDescription& scene, const Camera& camera,
                                         const RenderOptions& options);

}  // namespace raysheaf
