// A stream: thousands of rays towards one quarter of a face that traverse the tree together.
//
//   node  [ a . b . . c . . ]        list of rays at the node: 5 9 12 40 41 77 ...
//            |                       sixteen at a time they are tested with every child's box;
//            v                       those that intersect it are the child's list
//   list of a: 9 40 77 ...
//
// While sixteen neighbours stay together, a list names them as a bundle: a beam that bounds them is
// tested first, and no ray is gathered or moved. The remaining rays of sparse bundles continue as
// single rays.
//
// Every node is fetched once per stream, no branch depends on a single ray, and rays need not be
// coherent: they share only the quarter, which determines the order of the children from near to
// far. (I. Wald, C. Gribble, S. Boulos, A. Kensler, "SIMD Ray Stream Tracing", 2007; J. Tsakok,
// "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG 2009.)
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "base/buffer.h"
#include "exec/executor.h"
#include "methods/dual/bundle16.h"
#include "methods/dual/far_ray.h"

namespace raysheaf {

/// The maximum number of rays of a stream, and of a long one, which has no bundles: the more rays
/// traverse the tree together, the more of them share its deep nodes. Without bundles shadow rays
/// take 1.3 times as long, and without long streams random rays 1.2 times.
inline constexpr std::uint32_t kStreamRays = 4096, kLongStreamRays = 65536;

/// A ray on a cache line, in groups of four floats: the first two are for tests with triangles, the
/// third (with the origin) for tests with boxes, the last for the result. `s` and `along` as in
/// methods/dual/bundle16.h. A ray that begins far outside the scene has its moved origin here, and
/// as t_min its pad (methods/dual/far_ray.h).
struct alignas(64) StreamRay {
  float ox, oy, oz, t_limit;
  float shear_x, shear_y, shear_z, t_min;
  float per_x, per_y, s_near, s_far;
  float along = 0, t_low = 0;        ///< the best hit's t is between t_low and t_limit
  std::uint32_t place = kInvalidId;  ///< place of its triangle in the tree's quads; kInvalidId:
                                     ///< none
  float start = 0;                   ///< of box tests: 0, or as in FarRay
};
static_assert(sizeof(StreamRay) == 64);

/// Sixteen consecutive rays in columns: the fields of StreamRay.
struct alignas(64) StreamBundle {
  float ox[kBundleWidth], oy[kBundleWidth], oz[kBundleWidth], t_limit[kBundleWidth];
  float shear_x[kBundleWidth], shear_y[kBundleWidth], shear_z[kBundleWidth], t_min[kBundleWidth];
  float per_x[kBundleWidth], per_y[kBundleWidth], s_near[kBundleWidth], s_far[kBundleWidth];
  float along[kBundleWidth], t_low[kBundleWidth];
  std::uint32_t place[kBundleWidth];

  [[nodiscard]] StreamRay ray(std::uint32_t lane) const {
    return {ox[lane],      oy[lane],      oz[lane],    t_limit[lane], shear_x[lane],
            shear_y[lane], shear_z[lane], t_min[lane], per_x[lane],   per_y[lane],
            s_near[lane],  s_far[lane],   along[lane], t_low[lane],   place[lane]};
  }
};

/// A bundle, and its rays that are in a list: bit i is ray i of the bundle.
struct BundleRays {
  std::uint16_t bundle, rays;
};
/// The encoding in a list.
[[nodiscard]] inline std::uint32_t word_of(std::uint32_t bundle, std::uint32_t rays) {
  return std::bit_cast<std::uint32_t>(
      BundleRays{static_cast<std::uint16_t>(bundle), static_cast<std::uint16_t>(rays)});
}

/// A child whose list of rays is on the stack.
struct WaitingList {
  std::uint32_t first, count;  ///< as in BvhNode
  std::uint32_t offset, size;  ///< of its list
  bool in_bundles = false;     ///< a list of BundleRays; false: of rays
};

/// A hit of the ray at a place of the order.
struct RowHit {
  std::uint32_t place = 0;
  IndexedHit hit;
};

struct RayStream : QuarterAxes {
  Buffer<StreamRay> rays;       ///< with bundles: only the rays that have left them
  Buffer<std::uint32_t> index;  ///< the caller's numbers
  Buffer<StreamBundle> bundles;
  Buffer<Beam> beams;              ///< of the bundles
  Buffer<std::uint32_t> recorded;  ///< for each bundle, those of its rays that are in `rays`, as
                                   ///< bits
  Buffer<std::uint32_t> lists;
  std::vector<WaitingList> waiting;
  std::vector<RowHit> rows;            ///< if all hits are requested: those of the task's rays
  std::uint32_t first = 0, count = 0;  ///< places in the order
  Growth growth;
  bool are_far = false;    ///< the rays on their way now have moved origins
  bool one_start = false;  ///< with bundles: all rays have one origin and one t_min
  Vec3 origin;             ///< then: the rays', along the stream's axes

  RayStream() {
    fit(kStreamRays);
    bundles.resize_uninitialized(kStreamRays / kBundleWidth);
    beams.resize_uninitialized(kStreamRays / kBundleWidth);
    recorded.resize_uninitialized(kStreamRays / kBundleWidth);
  }
  /// Makes room for this many rays; loses the content.
  void fit(std::uint32_t size);
  /// Makes room for `size` numbers in `lists`; keeps the content.
  void grow_lists(std::size_t size);
  [[nodiscard]] std::size_t bytes() const {
    return rays.capacity_bytes() + index.capacity_bytes() + bundles.capacity_bytes() +
           beams.capacity_bytes() + recorded.capacity_bytes() + lists.capacity_bytes() +
           waiting.capacity() * sizeof(WaitingList) + rows.capacity() * sizeof(RowHit);
  }
};

// A batch as those see it who trace it.

/// Few rays, or those of a `StreamJob`.
struct TraceJob {
  const Executor& executor;  ///< checked for cancellation
  const DualScene scene;
  const Ray* const rays;
  const DualResults results;
};

/// A run of at most kBundleWidth rays of one quarter.
struct BundleRange {
  std::uint32_t first = 0, count = 0, quarter = 0;
};

/// Bundles [begin, end) of one task.
struct TraceTask {
  std::size_t number = 0, begin = 0, end = 0;
};

/// The results have a list of `rows` for each task.
struct StreamJob : TraceJob {
  const RayOrder& order;
  RayStreamPool* const streams;
  std::array<std::uint32_t, kQuarters + 1> bundle_starts{};

  [[nodiscard]] BundleRange bundle(std::size_t n) const {
    std::uint32_t quarter = 0;
    while (n >= bundle_starts[quarter + 1]) ++quarter;
    const auto first = order.starts[quarter] +
                       (static_cast<std::uint32_t>(n) - bundle_starts[quarter]) * kBundleWidth;
    return {first, std::min(kBundleWidth, order.starts[quarter + 1] - first), quarter};
  }
};

/// Cuts the rays into bundles. Returns those at which tasks begin, and the end.
[[nodiscard]] std::vector<std::size_t> cut_into_tasks(StreamJob* job);

/// Sorts the hits of the rays at places [first, end), which are in no order, into a list.
void make_rows(const Executor& executor, const std::vector<RowHit>& found, std::uint32_t first,
               std::uint32_t end, RowList* list);

}  // namespace raysheaf
