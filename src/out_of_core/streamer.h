// Batches of rays against blocks that stream past them.
//
//   blocks that a ray may hit, near ones first
//        │ a round of them                          ┌─ cull again: skip blocks behind the hits
//        ▼                                          ▼
//   [ read, decode, check ]  during the last one's [ rays that may hit it ] ─► least hits
//
// The work, counts and bytes depend only on the rays, the blocks and the size of a round, not on
// threads or on the speed of reading.
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

/// Requests of a batch in addition to its answers.
struct StreamRequest {
  std::string stage;  ///< name for the meter, which counts bytes
  ProgressMeter* meter = nullptr;
  Facing facing = Facing::kBoth;
  View<float> ray_tests;  ///< may be empty
  bool count = true;      ///< count tests, and measure a device's times
};

/// Memory per ray, and per block that is read and traced.
inline constexpr std::uint64_t kStreamRayBytes = 256, kStreamBlockBytes = std::uint64_t{24} << 20;
inline constexpr std::uint32_t kMostSlots = 16;

class Streamer {
 public:
  /// `slots`: the number of blocks that are traced at once, while as many are read. Uses from
  /// `options`: `front_to_back`, `part`, `parts`, `exchange`, `checkpoint`, `statistics` and, as a
  /// device's limit, `memory_bytes`. `device`: the one that traces; null: the CPU. All must outlive
  /// this object.
  Streamer(const Executor& executor, const GeometrySource& source, const StreamOptions& options,
           std::uint32_t slots, const DeviceBackend* device = nullptr);
  Streamer(const Streamer&) = delete;
  Streamer& operator=(const Streamer&) = delete;
  ~Streamer();

  [[nodiscard]] const GeometrySource& source() const { return source_; }
  /// Combines this process's hits with others'; null: a single process.
  [[nodiscard]] HitExchange* exchange() const { return options_.exchange; }
  /// Whether a block belongs to this process.
  [[nodiscard]] bool is_own(std::size_t block) const {
    return block % options_.parts == options_.part;
  }
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  [[nodiscard]] std::uint64_t triangle_count() const { return triangle_count_; }
  [[nodiscard]] const StreamStatistics& statistics() const { return statistics_; }

  /// hits[i] receives the least hit of rays[i]; occluded[i] is 1 if it hits anything. Rays must
  /// have been validated. The report receives counts, times and a sentence.
  void closest(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
               QueryReport* report);
  void any(View<const Ray> rays, const StreamRequest& request, View<std::uint8_t> occluded,
           QueryReport* report);

 private:
  friend class Sweep;

  /// One of `hits` and `occluded` is empty.
  void sweep(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
             View<std::uint8_t> occluded, QueryReport* report);
  /// Processes rays from `first` on, as many as the tracer takes at once.
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

/// Throws `Error` (kInvalidArgument) if `part` is not below `parts`.
void check_parts(const StreamOptions& options);

void add(const StreamStatistics& more, StreamStatistics* sum);
/// The sum over the processes of `exchange`; null: those of this one.
[[nodiscard]] StreamStatistics of_all(StreamStatistics own, HitExchange* exchange);

/// The number of slots that fit into `memory_bytes` in addition to what is `taken`, for batches of
/// `rays`. Throws `Error` (kOutOfMemory) if not even one fits.
[[nodiscard]] std::uint32_t slots_for(std::uint64_t memory_bytes, std::uint64_t taken,
                                      std::uint64_t rays);

}  // namespace raysheaf
