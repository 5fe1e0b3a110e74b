// A method is a setting of the one pipeline.
#pragma once

#include <cstdint>

#include "raysheaf/render.h"

namespace raysheaf {

struct MethodSettings {
  bool hierarchy = true;     ///< false: every ray with every triangle
  bool sort = true;          ///< false: rays stay in trimmed raster order
  bool mesh_culling = true;  ///< mesh spheres before their triangles
  std::uint32_t levels = 2, branching = 8;
};

[[nodiscard]] inline MethodSettings method_settings(Method method, std::uint32_t levels,
                                                    std::uint32_t branching) {
  MethodSettings settings;
  settings.hierarchy = method != Method::kBrute;
  settings.sort = settings.mesh_culling = method == Method::kCrsh;
  settings.levels = levels;
  settings.branching = branching;
  return settings;
}

}  // namespace raysheaf
