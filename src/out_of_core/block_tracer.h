// Traces rays that stay in place while blocks of triangles stream past them: the interface of a
// streamed query to a machine. out_of_core/cpu_block_tracer.h implements it on the CPU; this header
// makes the devices' tracers.
//
//   begin ─► find_distances ─► find_met ─► [ load ─► find_met ─► trace ]... ─► finish
//
//   the host     read, decode │ pack k+1  │         │ read k+2 ...
//   uplinks                   [ copy k+1 → a buffer that is free ]
//   the device   [ trace k: tree over the block, rays down it, least hits ][ cull ][ trace k+1 ]
//
// On a device, the rays in the order of a curve, the tree of shafts over them, their ends and their
// least hits stay in memory from `begin` to `finish`. The device does not wait for the host within
// a block: `trace` returns when all work is queued.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "queries/query_report.h"
#include "raysheaf/stream.h"

namespace raysheaf {

struct BlockBatch {
  View<const Ray> rays;  ///< validated; must not change until `finish`
  Box scene;             ///< contains all triangles
  Facing facing = Facing::kBoth;
  /// One is empty; the other receives the answers. The tracer does not use it before `collect`.
  View<StreamHit> hits;
  View<std::uint8_t> occluded;
  /// The answers hold the results of an earlier run; otherwise they are set to misses.
  bool resumed = false;
  bool count = true;      ///< fill the report
  View<float> ray_tests;  ///< may be empty; `finish` adds to it
};

/// A block and its number.
struct TracedBlock {
  std::uint32_t number = 0;
  const TriangleBlock* block = nullptr;
};

/// Counts of one batch.
struct BlockReport {
  std::uint64_t bound_tests = 0, ray_bound_tests = 0, triangle_tests = 0;
  std::uint64_t wasted_blocks = 0;  ///< traced, but no ray intersected it
  double cull_ms = 0, trace_ms = 0;
};

/// Traces one batch after another. Not for two threads at once. Throws Error: kOutOfMemory, or
/// kInternal with a device's message and the stage's name; after that, only the destructor may be
/// called.
class BlockTracer {
 public:
  virtual ~BlockTracer() = default;

  /// The most rays that a batch may have.
  [[nodiscard]] virtual std::size_t most_rays() const = 0;
  /// The best number of boxes to test together.
  [[nodiscard]] virtual std::size_t window() const = 0;
  /// Appends sentences that describe where this runs.
  virtual void explain(std::vector<std::string>* plan) const = 0;

  virtual void begin(const BlockBatch& batch) = 0;
  /// squared[i]: the squared distance from boxes[i] to the nearest box of origins of the rays that
  /// may intersect it; negative if no ray may. Called once per batch, with the boxes of all blocks.
  virtual void find_distances(View<const Box> boxes, View<float> squared) = 0;
  /// met[i]: 1 if a ray, shortened to its hit so far, may intersect boxes[i].
  virtual void find_met(View<const Box> boxes, View<std::uint8_t> met) = 0;
  /// Loads the blocks for `trace`; they must not change until it returns.
  virtual void load(View<const TracedBlock> round) = 0;
  virtual void trace() = 0;
  /// Copies the answers so far to the batch's arrays.
  virtual void collect() = 0;
  /// `collect`, and the batch's report.
  virtual BlockReport finish() = 0;
};

/// The resources that a tracer on a device may use.
struct BlockLimits {
  std::uint64_t memory_bytes = 0;   ///< of the device
  std::uint32_t most_buffers = 16;  ///< for blocks
  std::uint32_t most_triangles = kBlockTriangles;
};

}  // namespace raysheaf
