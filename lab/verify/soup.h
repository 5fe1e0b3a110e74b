// Unusual triangles and rays, at any scale and position.
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
  std::vector<std::vector<Vec3>> meshes;  ///< three corners per triangle; no mesh is empty

  [[nodiscard]] std::uint32_t triangle_count() const;
  [[nodiscard]] std::array<Vec3, 3> some_triangle(Random* random) const;
  /// "300 needles, scale 1e-05, at (0, 0, 0)"
  [[nodiscard]] std::string text() const;
  /// Adds the meshes, numbered as in `meshes`, each placed once and not transformed.
  void add_to(Scene* scene) const;
  [[nodiscard]] SceneDescription description() const;
};

/// The range of a soup's scale and position.
struct Reach {
  float smallest = 1e-20f, largest = 1e17f;  ///< scales
  float farthest = 1e7f;                     ///< from the world's origin, in scales
};

/// 1 to `most_triangles` of one kind.
[[nodiscard]] Soup make_soup(std::uint32_t most_triangles, const Reach& reach, Random* random);

/// Like `make_soup`, with a given scale and position.
[[nodiscard]] Soup make_soup_at(std::uint32_t most_triangles, float scale, Vec3 offset,
                                Random* random);

/// Within the coordinates that a scene accepts, with room for what is done to it later.
[[nodiscard]] Vec3 clamped(Vec3 p);
/// A corner, a point on an edge, or an inner point.
[[nodiscard]] Vec3 point_of(const std::array<Vec3, 3>& triangle, Random* random);
/// Often the whole ray; otherwise an interval that ends, begins or lies at t = 1 or 0.
void give_interval(Random* random, Ray* ray);
/// Finite, and with a direction that is not 0.
[[nodiscard]] bool is_legal(const Ray& ray);

/// Rays at vertices, along edges, in planes, along axes, from inside and from far away,
/// individually and in groups, with all kinds of intervals. All are valid.
[[nodiscard]] std::vector<Ray> make_rays(const Soup& soup, std::size_t count, Random* random);

/// Rays from one point, each with its own interval.
[[nodiscard]] std::vector<Ray> make_fan(const Soup& soup, std::size_t count, Random* random);

}  // namespace raysheaf::checks
