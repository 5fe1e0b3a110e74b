// Points against a committed scene (raysheaf/scene.h): what is nearest to them, how far it is, and
// whether they lie inside.
//
//   std::vector<raysheaf::Vec3> points = ...;
//   const std::vector<raysheaf::ClosestPoint> found = raysheaf::closest_point(scene, points);
//   const std::vector<double> distances = raysheaf::signed_distance(scene, points);
//
// Points may come in any order, as float or double; doubles are not rounded. As with rays
// (raysheaf/query.h) one large batch is far faster than many small ones, and the answers depend
// only on points and triangles, bit for bit: not on threads, SIMD, the method, the order of the
// batch, or earlier states of the scene. Triangles without area count: they are segments or points.
//
// Distances are computed in binary64 from the floats of the scene; they differ from the exact ones
// by at most 2^-48 of the distance and of the triangle's longest edge together. A triangle's
// distance is never above that of its edges and corners, and triangles that share an edge or a
// corner have the same distance to it, bit for bit. Ties go to the least (geom_id, inst_id,
// prim_id).
//
// A scene on a device answers there, with the same bits. Points and results may each lie in the
// host's memory or in the device's; radii lie where the points do, except that one radius for all
// (a row stride of 0) may lie in the host's. Points in the device's memory are validated there.
// Where processes share a context, each answers all of its points.
//
// All functions throw `Error`: kInvalidData naming the first point that is not finite or farther
// out than 1e18, or a radius that is negative or NaN; kInvalidArgument for spans of a wrong length;
// kUnsupported for points and radii in different memories; kWrongState, kCancelled and kOutOfMemory
// as ray queries do. Results are then unspecified.
#pragma once

#include <array>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "raysheaf/query.h"
#include "raysheaf/scene.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// A batch of `count` points. Coordinates smaller than 1e-60 count as 0.
struct PointParts {
  std::size_t count;
  NumberRows points;  ///< three numbers a row
  /// One number per row: triangles farther away are not found. Without data there is no limit.
  NumberRows radii;

  PointParts(std::size_t number, NumberRows point_rows, NumberRows radius_rows = {})
      : count(number), points(point_rows), radii(radius_rows) {}
  /// Any contiguous list of `Vec3`, or of three doubles each.
  template <class List>
  requires std::convertible_to<const List&, std::span<const Vec3>> PointParts(
      const List& list)  // NOLINT: a view
      : PointParts(std::span<const Vec3>(list)) {}
  template <class List>
  requires std::convertible_to<const List&, std::span<const std::array<double, 3>>> PointParts(
      const List& list)  // NOLINT: a view
      : PointParts(std::span<const std::array<double, 3>>(list)) {}
  PointParts(std::span<const Vec3> list)  // NOLINT: a view
      : count(list.size()), points(list.empty() ? nullptr : &list.front().x) {}
  PointParts(std::span<const std::array<double, 3>> list)  // NOLINT: a view
      : count(list.size()), points(list.empty() ? nullptr : list.front().data()) {}
};

/// The triangle nearest to a point. If no triangle is within the radius, the distance is infinite,
/// the point NaN, and the ids are `kInvalidId`.
struct ClosestPoint {
  double distance = std::numeric_limits<double>::infinity();
  std::array<double, 3> point = {std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::quiet_NaN()};
  double u = 0, v = 0;  ///< weights of the triangle's second and third corner; in [0, 1]
  std::uint32_t prim_id = kInvalidId;
  std::uint32_t geom_id = kInvalidId;
  std::uint32_t inst_id = kInvalidId;
  /// On which side of the triangle's plane the point lies, exactly: 1 where the corners run
  /// counter-clockwise as seen from it, -1 where they run clockwise, 0 in the plane and for
  /// triangles without area.
  std::int32_t side = 0;
};
static_assert(sizeof(ClosestPoint) == 64);

/// Whether a point is inside, by the number of times that the surface winds around it.
///
/// A ray from the point counts 1 where it leaves through the front of a triangle and -1 where it
/// enters through it: the sum is the winding number, an integer, computed by exact predicates. A
/// point on an edge of the projection counts as if it lay a little farther along +x, +y and +z (by
/// ever smaller amounts), so that of adjoining solids exactly one has it.
///
/// Where the surface is closed (every edge of its triangles, by the coordinates of its ends, is
/// used as often one way as the other), all rays have the same sum, and one is asked. Elsewhere it
/// is the mean over the six directions along the axes: what the generalised winding number
/// (Jacobson et al. 2013) is over all directions, but without rounding, and the same from any
/// hierarchy.
enum class InsideRule : std::uint8_t {
  /// Where the winding number, or the mean, is nearer to other integers than to 0: more than 1/2 in
  /// absolute value. Solids may overlap; which way all triangles face does not matter.
  kNonZero,
  /// Where rays cross an odd number of triangles; of open surfaces, more than three of the six. For
  /// triangles that face either way at random.
  kEvenOdd,
};

struct PointOptions {
  QueryMethod method = QueryMethod::kDual;
  /// The query sees an instance if (the instance's mask & this) != 0.
  std::uint32_t mask = 0xffffffff;
  /// Refuse wrong points and radii. Without validation, a wrong one makes the results of its whole
  /// batch unspecified.
  bool check = true;
  InsideRule inside = InsideRule::kNonZero;
  /// As in `QueryOptions`.
  void* stream = nullptr;
  void* results_stream = nullptr;
  const std::atomic<bool>* stop = nullptr;
  /// Written unless null; `rays` counts points, tests are not counted.
  QueryStatistics* statistics = nullptr;
  /// As `QueryOptions::ray_worlds` and `rays_per_world`: a point sees the instances of its world,
  /// and is inside what only these enclose. On Device::kCuda the CPU's threads answer then.
  std::span<const WorldId> point_worlds{};
  std::size_t points_per_world = 0;
};

/// found[i] is the nearest point on a triangle of points[i]. Spans of equal length.
void closest_point(const Scene& scene, const PointParts& points, std::span<ClosestPoint> found,
                   const PointOptions& options = {});
[[nodiscard]] std::vector<ClosestPoint> closest_point(const Scene& scene, const PointParts& points,
                                                      const PointOptions& options = {});

inline constexpr std::size_t kMostNearest = 65536;

/// The `k` nearest triangles of each point, sorted by (distance, geom_id, inst_id, prim_id):
/// found[i * k] up to, excluding, found[(i + 1) * k] are those of points[i]. If a point has fewer,
/// the rest are `ClosestPoint{}`. `found` has k elements per point; k must be from 1 to
/// kMostNearest (else kInvalidArgument).
void nearest(const Scene& scene, const PointParts& points, std::size_t k,
             std::span<ClosestPoint> found, const PointOptions& options = {});
[[nodiscard]] std::vector<ClosestPoint> nearest(const Scene& scene, const PointParts& points,
                                                std::size_t k, const PointOptions& options = {});

/// distances[i] is the distance of points[i], negative inside (`InsideRule`), infinite beyond its
/// radius. Spans of equal length.
void signed_distance(const Scene& scene, const PointParts& points, std::span<double> distances,
                     const PointOptions& options = {});
[[nodiscard]] std::vector<double> signed_distance(const Scene& scene, const PointParts& points,
                                                  const PointOptions& options = {});

/// inside[i] is 1 if points[i] lies inside (`InsideRule`), else 0. Radii are not used. Spans of
/// equal length.
void contains(const Scene& scene, const PointParts& points, std::span<std::uint8_t> inside,
              const PointOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> contains(const Scene& scene, const PointParts& points,
                                                 const PointOptions& options = {});

}  // namespace raysheaf
