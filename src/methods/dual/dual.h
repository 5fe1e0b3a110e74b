// Traces bundles of rays through the object tree: the core of `dual`.
//
//   bundle: 16 rays towards one face        beam: the region that contains them
//
//        x ^      . - ' |                   at two planes across the axis, the smallest and the
//          |  . '       |  . - '            largest x (and y) of the rays; straight lines between
//          |    |   . - '                   them. A box intersects the beam if at some z the beam's
//          | .- '_ _ _ _|_                  rectangle overlaps it: an interval of z, whose near end
//          +--------------------> z         determines which box comes first
//           start      end
//
// A box of a node is tested with sixteen beams at once, and then with the rays of those beams that
// intersect it, which hits may have shortened. Boxes that rays intersect go on a stack, nearest on
// top. If only few rays intersect a box, they continue one by one, testing eight boxes at a time.
// Decision 18 (docs/decisions/0018-ways-of-dual.md) has what each way is worth.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/buffer.h"
#include "base/spares.h"
#include "base/view.h"
#include "exec/executor.h"
#include "intersect/hit_filter.h"
#include "intersect/indexed_hit.h"
#include "intersect/intersect_list.h"
#include "methods/dual/ray_order.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

/// Streams that are not in use (methods/dual/ray_stream.h): a thread takes one and returns it.
struct RayStream;
using RayStreamPool = Spares<RayStream>;

/// How rays traverse the tree together.
enum class Bundle : std::uint8_t {
  kStream,      ///< thousands of rays, in lists of bundles of sixteen or of single rays
                ///< (methods/dual/ray_stream.h): for rays that are coherent with their neighbours
  kLongStream,  ///< tens of thousands of rays, in lists of single rays: for all others
};

struct DualScene {
  const ObjectTree* tree = nullptr;
  const std::uint8_t* flags = nullptr;  ///< TriangleFlag by triangle number, or null
  Facing facing = Facing::kBoth;
  Bundle bundle = Bundle::kStream;
  RayStreamPool* streams = nullptr;   ///< kept from query to query; null: the query's own
  const HitFilter* filter = nullptr;  ///< of hits, by the rays' numbers; null: all count
};

/// Counts are the same with any number of threads and on every SIMD target.
struct DualCounts {
  std::uint64_t beam_box_tests = 0, ray_box_tests = 0, triangle_tests = 0;

  [[nodiscard]] std::uint64_t sum() const {
    return beam_box_tests + ray_box_tests + triangle_tests;
  }
  void add(const DualCounts& other) {
    beam_box_tests += other.beam_box_tests;
    ray_box_tests += other.ray_box_tests;
    triangle_tests += other.triangle_tests;
  }
};

/// All hits of consecutive rays of a `RayOrder`: row i is that of the ray at place first + i,
/// sorted by (t, triangle), and ends at ends[i].
struct RowList {
  std::uint32_t first = 0;
  Buffer<std::uint64_t> ends;  ///< 64 bits, because few rays may have many hits
  Buffer<IndexedHit> hits;

  [[nodiscard]] View<const IndexedHit> row(std::size_t i) const {
    const std::uint64_t begin = i == 0 ? 0 : ends[i - 1];
    return {hits.data() + begin, ends[i] - begin};
  }
};
using RowLists = std::vector<RowList>;

/// All arrays are in the caller's order. If `ray_tests` is not empty, each ray's share of the tests
/// is added to it. The rays must have been validated: finite, with a direction, 0 <= t_min <=
/// t_max.
void trace_closest(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                   const RayOrder& order, View<IndexedHit> hits, View<float> ray_tests,
                   DualCounts* counts);
void trace_any(const Executor& executor, const DualScene& scene, View<const Ray> rays,
               const RayOrder& order, View<std::uint8_t> occluded, View<float> ray_tests,
               DualCounts* counts);
/// `rows` receives the rows of all rays, in their order; its memory is reused.
void trace_all(const Executor& executor, const DualScene& scene, View<const Ray> rays,
               const RayOrder& order, RowLists* rows, View<float> ray_tests, DualCounts* counts);
/// Counts the hits of each ray without storing them.
void trace_hit_counts(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                      const RayOrder& order, View<std::uint32_t> hit_counts, DualCounts* counts);

}  // namespace raysheaf
