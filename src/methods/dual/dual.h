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

/// Where the results of a batch go, in the caller's order. Exactly one of the first four is given,
/// and determines what is traced.
struct DualResults {
  View<IndexedHit> hits = {};           ///< the closest
  View<std::uint8_t> occluded = {};     ///< 1: the ray has a hit
  RowLists* rows = nullptr;             ///< all hits, in the rays' order; their memory is reused
  View<std::uint32_t> hit_counts = {};  ///< the number of hits, which are not stored
  View<float> ray_tests = {};           ///< each ray's share of the tests is added; may be empty
};

/// Traces a batch, or with `Executor::serial()` a thread's tile of one. Adds to `counts`, which may
/// be null. The rays must have been validated: finite, with a direction, 0 <= t_min <= t_max.
void trace_rays(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                const RayOrder& order, const DualResults& results, DualCounts* counts);

/// The most rays of `trace_few_rays`.
inline constexpr std::uint32_t kFewTogether = 256;

/// The same for few rays, at most kFewTogether, in any order: each by itself, whatever the bundle
/// says, and without an allocation. The results are `hits` or `occluded`.
void trace_few_rays(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                    const DualResults& results, DualCounts* counts);

}  // namespace raysheaf
