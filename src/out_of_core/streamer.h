// Batches of rays against blocks that stream past them.
//
//   blocks that a ray may meet, near ones first
//        │ a round of them                          ┌─ cull again: what is behind the hits is left
//        ▼                                          ▼
//   [ read, decode, check ]  while the last one's  [ rays that meet it ] ─► least hits
//
// What happens depends on the rays, the blocks and the size of a round alone, not on threads nor on
// how fast anything is read: so do counts and bytes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "device/backend.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "out_of_core/block_reader.h"
#include "out_of_core/block_tracer.h"
#include "raysheaf/stream.h"

namespace raysheaf {

/// What a batch wants beside its answers.
struct StreamRequest {
  std::string stage;  ///< of the meter, which counts bytes
  ProgressMeter* meter = nullptr;
  Facing facing = Facing::kBoth;
  View<float> ray_tests;  ///< may be empty
  bool count = true;      ///< tests, and a device's times
};

/// Bytes that a ray takes here, and a block that is read and traced.
inline constexpr std::uint64_t kStreamRayBytes = 256, kStreamBlockBytes = std::uint64_t{24} << 20;
inline constexpr std::uint32_t kMostSlots = 16;

class Streamer {
 public:
  /// `slots`: blocks that are traced at once, while as many are read. `options`: `front_to_back`,
  /// `part`, `parts`, `exchange`, `checkpoint`, `statistics` and, for what a device may take,
  /// `memory_bytes` are used. `device`: where rays and blocks meet; null: here. All outlive it.
  Streamer(const Executor& executor, const GeometrySource& source, const StreamOptions& options,
           std::uint32_t slots, const DeviceBackend* device = nullptr);
  Streamer(const Streamer&) = delete;
  Streamer& operator=(const Streamer&) = delete;
  ~Streamer();

  [[nodiscard]] const GeometrySource& source() const { return source_; }
  /// That joins this process with others; null: alone.
  [[nodiscard]] HitExchange* exchange() const { return options_.exchange; }
  /// Whether a block is this process's.
  [[nodiscard]] bool is_own(std::size_t block) const {
    return block % options_.parts == options_.part;
  }
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  [[nodiscard]] std::uint64_t triangle_count() const { return triangle_count_; }
  [[nodiscard]] const StreamStatistics& statistics() const { return statistics_; }

  /// hits[i] takes the least hit of rays[i]; occluded[i] is 1 where it meets anything. Rays have
  /// been checked. The report takes counts, times and a sentence.
  void closest(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
               QueryReport* report);
  void any(View<const Ray> rays, const StreamRequest& request, View<std::uint8_t> occluded,
           QueryReport* report);

 private:
  friend class Sweep;

  /// One of `hits` and `occluded` is empty.
  void sweep(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
             View<std::uint8_t> occluded, QueryReport* report);
  /// Of rays from `first` on, as many as the tracer takes at once.
  void sweep_part(View<const Ray> rays, std::size_t first, const StreamRequest& request,
                  View<StreamHit> hits, View<std::uint8_t> occluded, QueryReport* report);

  const GeometrySource& source_;
  const StreamOptions& options_;
  Box bounds_;
  std::uint64_t triangle_count_ = 0;
  StreamStatistics statistics_;
  std::uint32_t batches_ = 0;  ///< so far
  std::size_t slots_;
  std::unique_ptr<BlockTracer> tracer_;
  std::vector<TriangleBlock> reading_, tracing_;
};

/// Throws `Error` (kInvalidArgument) where `part` is not among `parts`.
void check_parts(const StreamOptions& options);

void add(const StreamStatistics& more, StreamStatistics* sum);
/// The sum over the processes that `exchange` joins; null: those of this one.
[[nodiscard]] StreamStatistics of_all(StreamStatistics own, HitExchange* exchange);

/// How many slots `memory_bytes` have room for beside what is `taken`, for batches of `rays`.
/// Throws `Error` (kOutOfMemory) where that is not even one.
[[nodiscard]] std::uint32_t slots_for(std::uint64_t memory_bytes, std::uint64_t taken,
                                      std::uint64_t rays);

}  // namespace raysheaf
