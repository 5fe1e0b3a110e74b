// Measures the stages of ray queries on a CUDA device, and computes the least time that their
// memory traffic and arithmetic take. Also counts the work of the device's threads, without a
// device.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/lab.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

struct DeviceBenchOptions {
  std::uint32_t width = 512, height = 512;  ///< of the image that the rays come from
  /// Measured runs, of which the median counts, at least 1; one warm-up run precedes them.
  std::uint32_t runs = 9;
  /// Threads of the CPU that is measured for comparison; 0: all cores.
  std::uint32_t threads = 0;
  std::vector<LabRays> rays;  ///< the kinds that are measured; empty: all
};

/// A stage and its median time by the device's clock (CUDA events).
struct DeviceStage {
  std::string name;  ///< "order: sort", "trace: any hits", ...
  double ms = 0;
  /// Lower bound: the stage's bytes at the measured copy bandwidth, or its operations at the
  /// measured rate, whichever takes longer; 0: unknown.
  double floor_ms = 0;
  std::string floor_of;  ///< "bytes" or "operations"
};

/// One kind of rays. Before each run the triangles change, so that the hierarchy is rebuilt; in
/// further runs all triangles move, so that it is refitted.
struct DeviceBenchBatch {
  LabRays rays = LabRays::kShadow;
  std::uint64_t count = 0, hits = 0;
  /// Answers that differ from the CPU's in any bit, with either hierarchy: each is a defect.
  std::uint64_t different = 0;
  /// Copies between host and device are separate stages: "copy: ...".
  std::vector<DeviceStage> stages;
  /// Sum of the stages without copies; excludes the gaps between stages.
  double device_ms = 0;
  /// The part of `device_ms` without the hierarchy: from keys to hits.
  double trace_ms = 0;
  /// From keys to hits between one pair of events, including gaps; rays, hierarchy and hits are
  /// resident on the device.
  double keys_to_hits_ms = 0;
  /// The whole call measured on the host, including copies, without events.
  double call_ms = 0;
  double frame_ms = 0;                    ///< `call_ms` and the upload of all triangles before it
  std::vector<DeviceStage> refit_stages;  ///< of the hierarchy's refit
  double refit_ms = 0;                    ///< their sum
  double refit_frame_ms = 0;              ///< as `frame_ms`, with a refit
  double cpu_ms = 0;  ///< the same query on the CPU, including the hierarchy's rebuild
};

struct DeviceBenchReport {
  std::string device;
  std::uint32_t threads = 0;  ///< of the CPU
  std::uint64_t triangles = 0;
  double copy_gb_per_s = 0;  ///< reads plus writes, within the device's memory
  double gigaops_per_s = 0;  ///< multiplications and additions in binary32, not contracted
  /// Whether kernels can access the host's pageable memory. If they can, a kernel that gets a host
  /// pointer by mistake still computes correct answers, so the comparison with the CPU cannot
  /// detect such a defect.
  bool reads_host_memory = false;
  std::vector<DeviceBenchBatch> batches;
};

/// Runs queries by `dual`: shadow rays ask for any hit, all others for the closest. Throws `Error`:
/// kUnsupported without a device, with CUDA's message; kInvalidArgument for the options; as
/// `Laboratory`.
[[nodiscard]] DeviceBenchReport bench_device(const SceneDescription& scene,
                                             const DeviceBenchOptions& options = {});

/// How one kind of rays traverses the device's object tree: sums over all rays.
struct DeviceWalks {
  LabRays rays = LabRays::kShadow;
  std::uint64_t count = 0, hits = 0;
  std::uint64_t nodes = 0;      ///< visited nodes, of two boxes each
  std::uint64_t leaves = 0;     ///< visited leaves
  std::uint64_t triangles = 0;  ///< tested triangles
  /// Iterations of the loop over nodes and leaves. The threads of a warp, one for each ray, wait
  /// for the thread with the most iterations: this sums the maximum over each 32 consecutive rays.
  std::uint64_t warp_turns = 0;
  std::uint64_t sorted_warp_turns = 0;  ///< if the rays are sorted before, as queries do

  [[nodiscard]] std::uint64_t warps() const { return (count + 31) / 32; }
};

struct DeviceWalksReport {
  std::uint64_t triangles = 0;
  std::vector<DeviceWalks> batches;
};

/// Counts on the CPU with the device's own functions: needs no device, and the same rays give the
/// same numbers on every machine. Ignores `DeviceBenchOptions::runs`. Throws `Error` as
/// `Laboratory`.
[[nodiscard]] DeviceWalksReport count_device_walks(const SceneDescription& scene,
                                                   const DeviceBenchOptions& options = {});

}  // namespace raysheaf
