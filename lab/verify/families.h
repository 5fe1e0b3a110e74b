// Rays and points that ask a scene from anywhere: as users do, and as a bound fails.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lab/verify/soup.h"

namespace raysheaf::checks {

struct RayFamily {
  const char* name;
  /// All are valid. The soup has triangles.
  std::vector<Ray> (*make)(const Soup&, std::size_t count, Random*);
  bool is_whole = false;  ///< they suit meshes with whole numbers as coordinates, in scales
};

/// Those of soups (lab/verify/soup.h) and of whole meshes; images of a camera, parallel rays and
/// shadow segments from nearby to 10^12 scales away; rays from far away at single triangles, some
/// exactly at corners; near rays with some far ones among them; special values.
[[nodiscard]] std::span<const RayFamily> ray_families();

/// The same rays; those that hit begin or end there, or a float before or after.
[[nodiscard]] std::vector<Ray> cut_at(std::vector<Ray> rays, std::span<const float> t,
                                      Random* random);

/// On corners, edges and faces, near them, anywhere, and up to 10^12 scales away. Coordinates are
/// floats, except for points that are a little off a triangle.
[[nodiscard]] std::vector<std::array<double, 3>> make_points(const Soup& soup, std::size_t count,
                                                             Random* random);

}  // namespace raysheaf::checks
