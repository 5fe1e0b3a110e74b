// A stream: thousands of rays towards one quarter of a face that go down the tree together.
//
//   node  [ a . b . . c . . ]        list of rays at the node: 5 9 12 40 41 77 ...
//            |                       sixteen at a time they are tested with every child's box;
//            v                       those that meet it are the child's list
//   list of a: 9 40 77 ...
//
// Every node is fetched once a stream, no branch depends on a single ray, and rays need not be
// alike: what they share is the quarter, which tells the order of the children from near to far.
// (I. Wald, C. Gribble, S. Boulos, A. Kensler, "SIMD Ray Stream Tracing", 2007; J. Tsakok,
// "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG 2009.)
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "base/buffer.h"
#include "dual/packet.h"

namespace raysheaf {

inline constexpr std::uint32_t kStreamRays = 4096;

/// What boxes are tested with; `s` as in dual/packet.h.
struct alignas(32) StreamRay {
  float ox, oy, oz, per_x;
  float per_y, s_near, s_far, along;
};

/// What triangles are tested with beside the origin.
struct alignas(32) StreamShear {
  float shear_x, shear_y, shear_z, t_min;
  float t_limit, unused[3];
};

/// A child whose rays wait for their turn.
struct WaitingList {
  std::uint32_t first, count;  ///< as in BvhNode
  std::uint32_t offset, size;  ///< of its list
};

/// A hit of the ray at a place of the order.
struct RowHit {
  std::uint32_t place = 0;
  EngineHit hit;
};

struct Stream {
  Buffer<StreamRay> rays;
  Buffer<StreamShear> shears;
  Buffer<EngineHit> hits;  ///< any-hit: `triangle` is the place in the tree of one that was met
  Buffer<std::uint32_t> index;  ///< the caller's numbers
  Buffer<std::uint32_t> lists;
  std::vector<WaitingList> waiting;
  std::vector<RowHit> rows;  ///< where all hits are asked for: of the task's rays
  int axis_x = 0, axis_y = 0, axis_z = 0;
  int near_x = 0, near_y = 0, near_z = 0;  ///< as in RayPacket
  int far_x = 0, far_y = 0, far_z = 0;
  bool mirrored = false;
  std::uint32_t first = 0, count = 0;  ///< places in the order
  float pad = 0;                       ///< the largest of the packets'

  Stream() {
    rays.resize_uninitialized(kStreamRays);
    shears.resize_uninitialized(kStreamRays);
    hits.resize_uninitialized(kStreamRays);
    index.resize_uninitialized(kStreamRays);
    lists.resize_uninitialized(std::size_t{16} * kStreamRays);
  }
  /// Room for `size` numbers in `lists`, what is there kept.
  void grow_lists(std::size_t size);
  [[nodiscard]] std::size_t bytes() const {
    return rays.capacity_bytes() + shears.capacity_bytes() + hits.capacity_bytes() +
           index.capacity_bytes() + lists.capacity_bytes() +
           waiting.capacity() * sizeof(WaitingList) + rows.capacity() * sizeof(RowHit);
  }
};

/// Streams that are not in use: a thread takes one and gives it back.
class StreamPool {
 public:
  [[nodiscard]] std::unique_ptr<Stream> take();
  void give(std::unique_ptr<Stream> stream);
  [[nodiscard]] std::size_t bytes() const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Stream>> free_;
};

}  // namespace raysheaf
