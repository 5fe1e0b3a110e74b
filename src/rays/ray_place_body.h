// Where a ray is among others: cells of origins and of directions, and their place on a Morton
// curve.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "base/vec.h"
#include "rays/curve_body.h"

namespace raysheaf {

/// The scene's box, enlarged to a cube from the same corner, so that its cells are cubes.
struct KeyCube {
  Box box;
  float scale = 0;  ///< 1 / side; 0 for a scene without extent
};

RAYSHEAF_HD inline KeyCube key_cube(const Box& box) {
  const float side = max_component(box.max - box.min);
  return {box, side > 0 && std::isfinite(side) ? 1 / side : 0};
}

/// Maps a number in [0, 1] to one of 2^bits cells; numbers outside and NaN to the nearest end.
RAYSHEAF_HD inline std::uint32_t cell_of(float x, std::uint32_t bits) {
  const std::uint32_t cells = 1u << bits;
  if (!(x > 0)) return 0;
  return x < 1 ? static_cast<std::uint32_t>(x * static_cast<float>(cells)) : cells - 1;
}

/// Clips [*first, *last] to where `o + t d` is between `lo` and `hi`.
RAYSHEAF_HD inline void clip_to_slab(float lo, float hi, float o, float d, float* first,
                                     float* last) {
  if (d == 0) return;
  const float a = (lo - o) / d, b = (hi - o) / d;
  const float near_side = a < b ? a : b, far_side = a < b ? b : a;
  if (near_side > *first) *first = near_side;
  if (far_side < *last) *last = far_side;
}

struct RayEnds {
  Vec3 start, end;
};

/// For a ray that misses the box, both ends are one point.
RAYSHEAF_HD inline RayEnds ray_ends(const Box& box, const Ray& ray) {
  float first = ray.t_min, last = ray.t_max;
  clip_to_slab(box.min.x, box.max.x, ray.origin.x, ray.direction.x, &first, &last);
  clip_to_slab(box.min.y, box.max.y, ray.origin.y, ray.direction.y, &first, &last);
  clip_to_slab(box.min.z, box.max.z, ray.origin.z, ray.direction.z, &first, &last);
  if (!(last < std::numeric_limits<float>::infinity())) last = first;
  if (last < first) first = last = last > ray.t_min ? last : ray.t_min;
  return {ray.origin + ray.direction * first, ray.origin + ray.direction * last};
}

/// Maps directions to the unit square (octahedral map: Q. Meyer et al., "On Floating-Point Normal
/// Vectors", EGSR 2010). The direction need not be a unit vector.
RAYSHEAF_HD inline Vec2 octahedral(Vec3 d) {
  const float norm = std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z);
  if (!(norm > 0)) return {0.5f, 0.5f};
  float u = d.x / norm, v = d.y / norm;
  if (d.z < 0) {
    const float folded = (1 - std::fabs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - std::fabs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded;
  }
  return {u * 0.5f + 0.5f, v * 0.5f + 0.5f};
}

RAYSHEAF_HD inline Cell<2> square_cell(Vec2 p, std::uint32_t bits) {
  return {{cell_of(p.x, bits), cell_of(p.y, bits)}};
}

RAYSHEAF_HD inline Cell<3> cube_cell(const KeyCube& cube, Vec3 p, std::uint32_t bits) {
  const Vec3 q = (p - cube.box.min) * cube.scale;
  return {{cell_of(q.x, bits), cell_of(q.y, bits), cell_of(q.z, bits)}};
}

template <int kA, int kB>
RAYSHEAF_HD inline Cell<kA + kB> joined(const Cell<kA>& a, const Cell<kB>& b) {
  Cell<kA + kB> cell;
  for (int i = 0; i < kA; ++i) cell.axis[i] = a.axis[i];
  for (int i = 0; i < kB; ++i) cell.axis[kA + i] = b.axis[i];
  return cell;
}

/// The place of a ray on a Morton curve through the octahedral map of directions and the scene's
/// cube, at the point where the ray enters it: rays with similar origins and directions are near.
RAYSHEAF_HD inline std::uint64_t ray_place(const Ray& ray, const Box& scene,
                                           std::uint32_t axis_bits) {
  const Vec3 start = ray_ends(scene, ray).start;
  return morton_place(joined(square_cell(octahedral(normalized(ray.direction)), axis_bits),
                             cube_cell(key_cube(scene), start, axis_bits)));
}

}  // namespace raysheaf
