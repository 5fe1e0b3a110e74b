// Triangles and rays that no artist would make, at any scale and place.
#pragma once

#include <string>
#include <vector>

#include "lab/verify/random.h"
#include "raysheaf/scene.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::checks {

struct Soup {
  std::string kind;
  float scale = 1;
  Vec3 offset;
  std::vector<std::vector<Vec3>> meshes;  ///< three corners a triangle; none is empty

  [[nodiscard]] std::uint32_t triangle_count() const;
  [[nodiscard]] std::array<Vec3, 3> some_triangle(Random* random) const;
  /// "300 needles, scale 1e-05, at (0, 0, 0)"
  [[nodiscard]] std::string text() const;
  /// Meshes numbered as in `meshes`, each placed once and not transformed.
  void add_to(Scene* scene) const;
  [[nodiscard]] SceneDescription description() const;
};

/// What a soup's scale and place may be.
struct Reach {
  float smallest = 1e-20f, largest = 1e17f;  ///< scales
  float farthest = 1e7f;                     ///< from the world's origin, in scales
};

/// 1 to `most_triangles` of one kind.
[[nodiscard]] Soup make_soup(std::uint32_t most_triangles, const Reach& reach, Random* random);

/// Rays at vertices, along edges, in planes, along axes, from inside and from far away, alone and
/// in bunches, with all kinds of intervals. Legal ones.
[[nodiscard]] std::vector<Ray> make_rays(const Soup& soup, std::size_t count, Random* random);

/// All from one point, with intervals of their own.
[[nodiscard]] std::vector<Ray> make_fan(const Soup& soup, std::size_t count, Random* random);

}  // namespace raysheaf::checks
