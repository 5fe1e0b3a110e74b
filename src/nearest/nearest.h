// Points against the object tree: the nearest triangles, and the winding number of the surface.
//
//   tile of points ─► along a Morton curve ─► sixteen at a time down the tree, from what those
//                                             before found ─► triangles by number
//
// A box is left aside where its distance exceeds that of the best triangle so far
// (nearest/point_triangle_body.h says why no triangle is missed). Triangles without area, which the
// object tree leaves out or makes points of, are in a tree of their own.
//
// Instead, points may go down the trees over instances, of all or of their world, and enter each
// where it stands (levels/level_scene.h): by boxes of its mesh that are placed where points meet
// them, or, where it is turned and scaled only, by points in the space of the mesh. Corners are
// placed where a triangle may be near, so the answers are the same, bit for bit.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "base/buffer.h"
#include "base/vec.h"
#include "base/view.h"
#include "exec/executor.h"
#include "exec/source.h"
#include "intersect/hit_filter.h"
#include "levels/forest.h"
#include "levels/level_scene.h"
#include "nearest/point.h"
#include "object_tree/object_tree.h"
#include "raysheaf/points.h"

namespace raysheaf {

using PointSource = Source<QueryPoint>;

inline constexpr std::uint64_t kNoTriangle = ~std::uint64_t{0};

/// A triangle by its number, and where its corners are: a lane of a quad of a tree.
struct FoundTriangle {
  double distance = std::numeric_limits<double>::infinity();
  /// On two levels: the number of the instance, and in the lower half that within its mesh.
  std::uint64_t triangle = kNoTriangle;
  std::uint32_t place = 0;  ///< 4 * quad + lane
  /// 0: the object tree, 1: that of triangles without area; on two levels, the instance's.
  std::uint32_t tree = 0;
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

/// Whether all rays from a point agree.
struct Closedness {
  bool winds = false;    ///< every edge is used as often one way as the other
  bool is_even = false;  ///< every edge is used an even number of times

  [[nodiscard]] bool suits(InsideRule rule) const {
    return rule == InsideRule::kNonZero ? winds : is_even;
  }
};

/// The triangles that points are compared with: the engine's tree, and a tree of the triangles
/// without area; or instances where they stand.
struct NearestScene {
  const ObjectTree* tree = nullptr;
  const ObjectTree* thin = nullptr;
  /// Which triangles of the trees a point sees, by the numbers of all points; null: all.
  const HitFilter* filter = nullptr;
  const LevelScene* levels = nullptr;  ///< in place of the trees
  ItemWorlds worlds = {};           ///< in which instances are seen, by the numbers of all points
  std::uint32_t mask = 0xffffffff;  ///< instances are seen whose mask shares a bit with it
  View<const Closedness> meshes = {};  ///< of each instance; only for what is inside

  [[nodiscard]] Box bounds() const {
    return levels != nullptr ? bounds_of(*levels) : tree->empty() ? thin->bounds : tree->bounds;
  }
  [[nodiscard]] Corners corners(const FoundTriangle& found) const {
    if (levels == nullptr) return corners_at(found.tree == 0 ? *tree : *thin, found.place);
    const LevelInstance& instance = levels->instances[found.tree];
    const Corners own = corners_at(*instance.tree, found.place);
    if (instance.placing.is_identity) return own;
    const Affine& map = instance.placing.map;
    return {transform_point(map, own.a), transform_point(map, own.b), transform_point(map, own.c)};
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
