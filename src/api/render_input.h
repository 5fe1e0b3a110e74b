// What a caller asks of a frame, looked over.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/render.h"

namespace raysheaf {

/// What a frame needs a pixel, with room for a batch of secondary rays beside the primary
/// fragments.
inline constexpr std::uint64_t kBytesPerPixel = 640;

/// Throws `Error` that names the first option which is out of range.
void check(const RenderOptions& options);

/// By name, then by index; the first where nothing is asked for, or one that frames the scene.
[[nodiscard]] Camera find_camera(const SceneDescription& scene, const std::string& wanted);

/// The scene's, or one that shows it from where the camera stands.
[[nodiscard]] std::vector<Light> find_lights(const SceneDescription& scene, const Camera& camera);

}  // namespace raysheaf
