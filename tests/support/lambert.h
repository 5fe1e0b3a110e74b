// Lambert's closed form for the irradiance from a polygon.
#pragma once

#include <array>
#include <cmath>

#include "base/vec.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::test {

/// The irradiance from a rectangle at a point on a surface with this normal. All of the rectangle
/// must be above the surface's horizon. It is L / 2 times the sum over the edges: the angle that
/// the edge subtends, times the cosine between the surface's normal and that of the plane of edge
/// and point (J. H. Lambert, "Photometria", 1760).
inline double lambert(const Light& light, Vec3 position, Vec3 normal) {
  const Vec3 up = cross(light.right, light.direction);
  const Vec3 across = light.right * (0.5f * light.width), along = up * (0.5f * light.height);
  const Vec3 center = light.position - position;
  const std::array<Vec3, 4> corners = {center - across - along, center + across - along,
                                       center + across + along, center - across + along};
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 a = normalized(corners[i]), b = normalized(corners[(i + 1) % 4]);
    const double angle =
        std::atan2(static_cast<double>(length(cross(a, b))), static_cast<double>(dot(a, b)));
    sum += angle * static_cast<double>(dot(normalized(cross(a, b)), normal));
  }
  const double radiance =
      static_cast<double>(light.intensity.x) / (static_cast<double>(light.width) * light.height);
  return std::fabs(0.5 * radiance * sum);
}

}  // namespace raysheaf::test
