// Positions, normals and sides of hits: what a ray that goes on from a surface needs.
//
//   const std::vector<raysheaf::Hit> hits = raysheaf::closest_hit(scene, rays);
//   const std::vector<raysheaf::HitPoint> points = raysheaf::hit_points(scene, rays, hits);
//   for (const raysheaf::HitPoint& point : points)
//     next.push_back({raysheaf::off_surface(point, to_lamp), 0, to_lamp, 1});
//
// The scene must be the one that was asked, as it was committed then. All functions throw `Error`:
// kInvalidArgument for spans of unequal length, kNotFound for a hit whose instance or triangle the
// scene does not have, kWrongState as queries do.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "raysheaf/query.h"

namespace raysheaf {

/// Where a ray meets a triangle. For a miss, numbers are NaN and vertices are `kInvalidId`.
struct HitPoint {
  /// World space: the corners, mixed by the weights of the hit. It is nearer to the triangle than
  /// origin + t direction, whose rounding grows with the distance.
  Vec3 position{kNothing, kNothing, kNothing};
  /// A unit vector in world space, square to the triangle, on its front.
  Vec3 normal{kNothing, kNothing, kNothing};
  /// How far along the normal rays that leave the surface start, so that they do not meet it again:
  /// it bounds the roundings of `position`.
  float clearance = kNothing;
  /// The corners: indices into the mesh's positions.
  std::array<std::uint32_t, 3> vertices{kInvalidId, kInvalidId, kInvalidId};
  /// Whether the ray comes from the front: the side from which the corners run counter-clockwise in
  /// the mesh's own space. A transform that mirrors does not turn a mesh inside out. The sign is
  /// that of the exact determinant.
  bool front = false;

  static constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
};

/// points[i] belongs to hits[i], which rays[i] found, at times[i] if the query had times.
void hit_points(const Scene& scene, std::span<const Ray> rays, std::span<const Hit> hits,
                std::span<HitPoint> points, std::span<const float> times = {});
/// The same with only the directions of the rays, three numbers a row.
void hit_points(const Scene& scene, const NumberRows& directions, std::span<const Hit> hits,
                std::span<HitPoint> points, std::span<const float> times = {});
[[nodiscard]] std::vector<HitPoint> hit_points(const Scene& scene, std::span<const Ray> rays,
                                               std::span<const Hit> hits,
                                               std::span<const float> times = {});

/// Only the normals, each turned to the side that its ray comes from; NaN for a miss.
void facing_normals(const Scene& scene, const NumberRows& directions, std::span<const Hit> hits,
                    std::span<Vec3> normals, std::span<const float> times = {});

/// The origin of a ray that leaves the surface along `direction`: the position, moved to the side
/// that the ray leaves to, by the clearance.
[[nodiscard]] Vec3 off_surface(const HitPoint& point, Vec3 direction);

}  // namespace raysheaf
