// The object hierarchy of `dual`: rebuilt or refitted for each frame.
//
//   nodes   [ . . . . . . . . ]  eight boxes each; the root is [0], children follow their parents
//   quads   | 7 2 9 - | 4 0 - - | ...   the corners of a leaf's triangles, four to a block
//
// The layout of quads lets a packet of rays broadcast one triangle from a cache line or two, and a
// single ray load four triangles (two quads: eight) as vectors.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/buffer.h"
#include "exec/executor.h"
#include "object_tree/bvh_node.h"
#include "object_tree/moved_triangles.h"
#include "object_tree/tree_scratch.h"
#include "scene/triangle_source.h"

namespace raysheaf {

/// Up to four triangles. Unused lanes repeat the first.
struct alignas(64) TriangleQuad {
  float vertex[3][3][4];  ///< [corner][axis][lane]
  std::uint32_t id[4];    ///< triangle numbers
  float reach[4];         ///< `reach_of` (intersect/triangle_body.h)
};
static_assert(sizeof(TriangleQuad) == 192);

inline constexpr std::uint32_t kQuadTriangles = 4;
/// The most triangles of a leaf in a coarse tree.
inline constexpr std::uint32_t kCoarseTriangles = 16;

/// A `BvhNode`; for leaves, `first` is the place of their first quad and `count` the number of
/// their triangles, which fill div_ceil(count, 4) quads. Boxes of lanes beyond `children`
/// are empty (+inf, -inf), so that no test of all eight lanes accepts them.
struct ObjectTree {
  Buffer<BvhNode> nodes;  ///< empty if no triangle has an area
  Buffer<TriangleQuad> quads;
  Box bounds;                   ///< of all triangles that have an area
  std::uint32_t triangles = 0;  ///< that it holds
  /// Expected tests of a long random ray: with nodes, eight boxes each, and with quads.
  float surface_area_cost = 0;

  /// Numbers of the triangles without area that the tree does not hold, ascending:
  /// `refit_object_tree` checks that they still have none.
  std::vector<std::uint32_t> left_out;
  /// The starts of the regions of `nodes`, and their end. All regions except the first contain
  /// whole subtrees, so that they can be processed in parallel; the first is above them.
  std::vector<std::uint32_t> region_starts;
  TreeScratch scratch;  ///< of the rebuild

  [[nodiscard]] bool empty() const { return nodes.size() == 0; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return nodes.capacity_bytes() + quads.capacity_bytes() + scratch.memory_bytes() +
           (left_out.capacity() + region_starts.capacity()) * sizeof(std::uint32_t);
  }
};

/// How `build_object_tree` joins triangles that follow each other on a surface.
enum class Joining {
  kNone,    ///< not at all: it sorts single triangles
  kStrips,  ///< it sorts strips of up to four, and leaves have one or more of them
  kLeaves   ///< it sorts whole leaves, whose quads are in the order of the source
};

struct TreeOptions {
  /// The most triangles of a leaf, 4 or `kCoarseTriangles`: a coarse tree is built in half to two
  /// thirds of the time, and traced more slowly.
  std::uint32_t leaf_triangles = kQuadTriangles;
  std::optional<Joining> joining = {};  ///< by default `joining_of`
  /// Also holds triangles without area, as points that nothing hits, so that every refit succeeds.
  bool keep_flat = false;
  /// With `keep_flat`: keeps their corners, which may be placed elsewhere (levels/level_scene.h).
  /// Such a tree must not be refitted.
  bool keep_corners = false;
};

/// By how well the source's triangles follow each other, judged by 2048 of them.
[[nodiscard]] Joining joining_of(const TriangleSource& source);

/// Replaces `tree`, whose memory is reused, by one along a Morton curve (Lauterbach et al. 2009,
/// "Fast BVH Construction on GPUs", section 4; Karras 2012, "Maximizing Parallelism in the
/// Construction of BVHs, Octrees, and k-d Trees"). Omits triangles without area (`has_no_area`),
/// unless they are kept. O(M). The same tree with any number of threads.
void build_object_tree(const Executor& executor, const TriangleSource& source, ObjectTree* tree,
                       const TreeOptions& options = {});

/// The same by the surface area heuristic: slower to build, faster to trace. O(M log M). At once;
/// `FineBuild` builds it in slices.
void build_fine_object_tree(const Executor& executor, const TriangleSource& source,
                            ObjectTree* tree);

/// The same for only these triangles, whether or not they have an area. It must not be refitted.
void build_object_tree_of(const Executor& executor, const TriangleSource& source,
                          View<const std::uint32_t> numbers, ObjectTree* tree);

/// New corners for those of the triangles that `tree` was built from which have moved: same count
/// and, normally, same indices. A triangle that has lost its area stays in its leaf as a point that
/// nothing hits; returns false, with the tree left unusable, where one that was left out has gained
/// it, so that the tree must be built again. The same tree as where all count as moved. O(M), with
/// a look at those that stayed.
[[nodiscard]] bool refit_object_tree(const Executor& executor, const TriangleSource& source,
                                     const MovedTriangles& moved, ObjectTree* tree);

}  // namespace raysheaf
