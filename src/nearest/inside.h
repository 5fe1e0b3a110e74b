// Whether points lie inside a surface: how often rays along the axes cross it, exactly
// (nearest/crossing_body.h). The rule is raysheaf/points.h's.
#pragma once

#include <cstdint>
#include <vector>

#include "nearest/nearest.h"
#include "raysheaf/points.h"

namespace raysheaf {

/// Edges are those of the same coordinates, with or without indices. By sums of hashes of 64 bits:
/// a surface that is closed is always known as such, and one that is not is taken for closed with a
/// probability of 2^-64 or so. O(count).
[[nodiscard]] Closedness closedness_of(const Executor& executor, const TriangleSource& source);

/// The points of a tile, in their order (nearest/tile_order.h).
struct InsideTask {
  const NearestScene* scene;  ///< with a filter, the surface counts as open
  InsideRule rule;
  bool closed;          ///< all rays from a point agree
  std::uint32_t begin;  ///< the number of points[0] among all
  const QueryPoint* points;
  const std::uint64_t* order;
  std::uint32_t count;
  /// The nearest triangle of each point: it saves rays where the surface is closed, for
  /// what is nearer than the surface is on the same side. Null: unknown.
  const FoundTriangle* found;
  double slack;  ///< as in NearestTask
  std::uint8_t* inside;
  std::vector<std::uint32_t>* stack;
  /// A point of an open surface may take a millisecond: this is checked before each.
  const Executor* executor;
};
void find_inside(const InsideTask& task);

/// inside[i] is 1 where point i is inside.
void find_inside(const Executor& executor, const NearestScene& scene, const PointSource& points,
                 InsideRule rule, bool closed, View<std::uint8_t> inside);

/// Distances to the nearest triangles, infinite where none is within the radius; negative inside.
void find_signed_distances(const Executor& executor, const NearestScene& scene,
                           const PointSource& points, InsideRule rule, bool closed,
                           View<double> distances);

}  // namespace raysheaf
