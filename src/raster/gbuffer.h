// Stage 1: the G-buffer, four RGBA32F images and one of ids, fetched from what primary visibility
// found.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "raygen/fragment.h"
#include "raysheaf/render.h"

namespace raysheaf {

/// Rows from the top. All zeros where nothing is seen.
struct GBuffer {
  std::vector<Vec4> position;  ///< world; w = 1
  std::vector<Vec4> normal;    ///< shading normal, world; w = roughness
  std::vector<Vec4> diffuse;   ///< w = transmission
  std::vector<Vec4> specular;  ///< reflectance at normal incidence; w = index of refraction
  std::vector<PixelIds> ids;   ///< none yet: whose triangles they are names them
};

/// `fragments`: one a pixel.
[[nodiscard]] GBuffer fetch_gbuffer(const Executor& executor, View<const Fragment> fragments);

}  // namespace raysheaf
