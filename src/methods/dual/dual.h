// Rays in bundles through the object tree: the heart of `dual`.
//
//   bundle: 16 rays towards one face        beam: what all of them stay in
//
//        x ^      . - ' |                   at two planes across the axis the smallest and the
//          |  . '       |  . - '            largest x (and y) of the rays; in between, straight
//          lines | |   . - ' '| | |.-'_ _ _ _|_                  a box is met where there is a z at
//          which the beam's
//          +--------------------> z         rectangle overlaps it: an interval of z, whose near end
//           start      end                  says which box comes first
//
// A node's eight boxes are tested with the beam at once; a box that the beam meets waits, nearest
// first, and is tested with the rays themselves when its turn comes and hits have shortened them.
// Where few rays are left in a box they go on one by one, eight boxes at a time.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/buffer.h"
#include "base/spares.h"
#include "base/view.h"
#include "exec/executor.h"
#include "intersect/indexed_hit.h"
#include "intersect/intersect_list.h"
#include "methods/dual/ray_order.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

/// Streams that are not in use (methods/dual/ray_stream.h): a thread takes one and gives it back.
struct RayStream;
using RayStreamPool = Spares<RayStream>;

/// How rays go down the tree together.
enum class Bundle : std::uint8_t {
  kSixteen,  ///< sixteen, bounded by a beam: for rays that resemble their neighbours
  kStream,   ///< thousands, in lists of sixteen at once or of rays (methods/dual/ray_stream.h): for
             ///< such, too
  kLongStream,  ///< tens of thousands, in lists of rays: for all others
};

struct DualScene {
  const ObjectTree* tree = nullptr;
  const std::uint8_t* flags = nullptr;  ///< TriangleFlag by number, or null
  Facing facing = Facing::kBoth;
  Bundle bundle = Bundle::kSixteen;
  RayStreamPool* streams = nullptr;  ///< kept from query to query; null: the query's own
};

/// The same with any number of threads and on every SIMD target.
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

/// Every hit of rays that follow each other in a `RayOrder`: row i is that of the ray at place
/// first + i, sorted by (t, triangle), and ends where ends[i] says.
struct RowList {
  std::uint32_t first = 0;
  Buffer<std::uint64_t> ends;  ///< 64 bits: few rays may have many hits
  Buffer<IndexedHit> hits;

  [[nodiscard]] View<const IndexedHit> row(std::size_t i) const {
    const std::uint64_t begin = i == 0 ? 0 : ends[i - 1];
    return {hits.data() + begin, ends[i] - begin};
  }
};
using RowLists = std::vector<RowList>;

/// All in the caller's order; `ray_tests` may be empty, else each ray's share is added to it. What
/// `rays` are must have been checked: finite, with a direction, 0 <= t_min <= t_max.
void trace_closest(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                   const RayOrder& order, View<IndexedHit> hits, View<float> ray_tests,
                   DualCounts* counts);
void trace_any(const Executor& executor, const DualScene& scene, View<const Ray> rays,
               const RayOrder& order, View<std::uint8_t> occluded, View<float> ray_tests,
               DualCounts* counts);
/// `rows`, whose memory is used again, takes the rows of all rays, in their order.
void trace_all(const Executor& executor, const DualScene& scene, View<const Ray> rays,
               const RayOrder& order, RowLists* rows, View<float> ray_tests, DualCounts* counts);
/// The lengths of these rows, of which nothing is kept.
void trace_hit_counts(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                      const RayOrder& order, View<std::uint32_t> hit_counts, DualCounts* counts);

}  // namespace raysheaf
