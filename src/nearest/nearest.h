// Points against the object tree: the nearest triangles, and the winding number of the surface.
//
//   tile of points ─► along a Morton curve ─► sixteen at a time down the tree, from what those
//                                             before found ─► triangles by number
//
// A box is left aside where its distance exceeds that of the best triangle so far
// (nearest/point_triangle_body.h says why no triangle is missed). Triangles without area, which the
// object tree leaves out or makes points of, are in a tree of their own.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "base/buffer.h"
#include "base/view.h"
#include "exec/executor.h"
#include "exec/source.h"
#include "intersect/hit_filter.h"
#include "nearest/point.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

using PointSource = Source<QueryPoint>;

/// A triangle by its number, and where its corners are: a lane of a quad of one of the two trees.
struct FoundTriangle {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kInvalidId;
  std::uint32_t place = 0;  ///< 4 * quad + lane
  std::uint32_t tree = 0;   ///< 0: the object tree, 1: that of triangles without area
};

/// Sorted by (distance, number).
inline bool is_nearer(const FoundTriangle& a, const FoundTriangle& b) {
  return a.distance < b.distance || (a.distance == b.distance && a.triangle < b.triangle);
}

struct Corners {
  Vec3 a, b, c;
};
inline Corners corners_at(const ObjectTree& tree, std::uint32_t place) {
  const TriangleQuad& quad = tree.quads[place / kQuadTriangles];
  const std::uint32_t lane = place % kQuadTriangles;
  const auto corner = [&](int k) {
    return Vec3{quad.vertex[k][0][lane], quad.vertex[k][1][lane], quad.vertex[k][2][lane]};
  };
  return {corner(0), corner(1), corner(2)};
}

/// Whether all corners of a lane's triangle are one point: of the object tree, that it has no area.
inline bool is_point(const TriangleQuad& quad, std::uint32_t lane) {
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 1; k < 3; ++k)
      if (quad.vertex[k][axis][lane] != quad.vertex[0][axis][lane]) return false;
  return true;
}

/// The triangles that points are compared with: the engine's tree, and a tree of the triangles
/// without area.
struct NearestScene {
  const ObjectTree* tree = nullptr;
  const ObjectTree* thin = nullptr;
  /// Which triangles a point sees, by the numbers of all points; null: all.
  const HitFilter* filter = nullptr;

  [[nodiscard]] const ObjectTree& operator[](std::uint32_t which) const {
    return which == 0 ? *tree : *thin;
  }
};

/// The triangles without area: those that `tree` has left out, and those that a refit has made
/// points of. O(quads), and O(n log n) of what it finds.
void build_thin_tree(const Executor& executor, const TriangleSource& source, const ObjectTree& tree,
                     ObjectTree* thin);

/// A tile of points and their results.
struct NearestTile {
  std::size_t begin;  ///< its first point's number among all
  View<const QueryPoint> points;
  const std::uint64_t* order;       ///< as nearest/tile_order.h has it
  View<const FoundTriangle> found;  ///< k a point, sorted, and behind them `FoundTriangle{}`
};

/// The `k` nearest triangles of each point: `take(tile)` is called for disjoint ranges of points
/// that make up all, in any order and by several threads.
void find_nearest(const Executor& executor, const NearestScene& scene, const PointSource& points,
                  std::uint32_t k, const std::function<void(const NearestTile&)>& take);

/// More than the error of any distance to a triangle of these trees, except its part of 2^-30 of
/// the distance.
[[nodiscard]] double slack_of(const NearestScene& scene);

}  // namespace raysheaf
