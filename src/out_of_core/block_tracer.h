// Rays that stay where they are while blocks of triangles stream past them: what a batch of a
// streamed query asks of a machine. out_of_core/cpu_block_tracer.h is the CPU's; devices have this
// one.
//
//   begin ─► find_distances ─► find_met ─► [ load ─► find_met ─► trace ]... ─► finish
//
//   the host     read, decode │ pack k+1  │         │ read k+2 ...
//   uplinks                   [ copy k+1 → a buffer that is free ]
//   the device   [ trace k: tree over the block, rays down it, least hits ][ cull ][ trace k+1 ]
//
// On a device rays in the order of a curve, the tree of shafts over them, their ends and their
// least hits stay from `begin` to `finish`. Nothing of a block waits for the host: `trace` returns
// when all is asked for.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "queries/query_report.h"
#include "raysheaf/stream.h"

namespace raysheaf {

struct BlockBatch {
  View<const Ray> rays;  ///< checked; stay until `finish`
  Box scene;             ///< holds all triangles
  Facing facing = Facing::kBoth;
  /// One is empty: the other takes the answers, and is none of the tracer's before `collect`.
  View<StreamHit> hits;
  View<std::uint8_t> occluded;
  /// The answers have what an earlier run found; else they are misses.
  bool resumed = false;
  bool count = true;      ///< fill the report
  View<float> ray_tests;  ///< may be empty; added to by `finish`
};

/// A block, and its number.
struct TracedBlock {
  std::uint32_t number = 0;
  const TriangleBlock* block = nullptr;
};

/// Of one batch.
struct BlockReport {
  std::uint64_t bound_tests = 0, ray_bound_tests = 0, triangle_tests = 0;
  std::uint64_t wasted_blocks = 0;  ///< traced, and met by no ray
  double cull_ms = 0, trace_ms = 0;
};

/// One batch after another. Not for use by two threads at once. Throws Error: kOutOfMemory,
/// kInternal with a device's words and the stage's name; after that, only its destructor may run.
class BlockTracer {
 public:
  virtual ~BlockTracer() = default;

  /// Rays that a batch may have.
  [[nodiscard]] virtual std::size_t most_rays() const = 0;
  /// Boxes that are best asked about together.
  [[nodiscard]] virtual std::size_t window() const = 0;
  /// Says where this runs, for people.
  virtual void explain(std::vector<std::string>* plan) const = 0;

  virtual void begin(const BlockBatch& batch) = 0;
  /// squared[i]: from boxes[i] to the nearest box of origins of the rays that may meet it; negative
  /// where none may. Called once a batch, with all boxes that there will be blocks of.
  virtual void find_distances(View<const Box> boxes, View<float> squared) = 0;
  /// met[i]: 1 where a ray that ends at its hit so far may meet boxes[i].
  virtual void find_met(View<const Box> boxes, View<std::uint8_t> met) = 0;
  /// The blocks that `trace` is to trace; they stay until it returns.
  virtual void load(View<const TracedBlock> round) = 0;
  virtual void trace() = 0;
  /// The answers so far are where the batch wants them.
  virtual void collect() = 0;
  /// `collect`, and all else that there is to know of the batch.
  virtual BlockReport finish() = 0;
};

/// What a tracer on a device may take, and for what.
struct BlockLimits {
  std::uint64_t memory_bytes = 0;   ///< of the device's
  std::uint32_t most_buffers = 16;  ///< of blocks
  std::uint32_t most_triangles = kBlockTriangles;
};

}  // namespace raysheaf
