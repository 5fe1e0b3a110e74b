// How long the stages of ray queries take on a CUDA device, beside what their memory traffic and
// their arithmetic cost at least. And what its threads do in them, counted without a device.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/lab.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

struct DeviceBenchOptions {
  std::uint32_t width = 512, height = 512;  ///< of the picture that rays come from
  std::uint32_t runs = 9;                   ///< whose medians count, from 1; one more goes before
  std::uint32_t threads = 0;                ///< of the CPU beside it; 0: all cores
  std::vector<LabRays> rays;                ///< the kinds that are measured; none: all
};

/// A stage's median, by the device's own clock (CUDA events).
struct DeviceStage {
  std::string name;  ///< "order: sort", "trace: any hits", ...
  double ms = 0;
  /// Its bytes at the measured copy bandwidth, or its operations at the measured rate, whichever
  /// takes longer; 0: not known.
  double floor_ms = 0;
  std::string floor_of;  ///< "bytes" or "operations"
};

/// One kind of rays. The triangles change before each run, so that the hierarchy is built anew;
/// then all of them move, so that it is refitted.
struct DeviceBenchBatch {
  LabRays rays = LabRays::kShadow;
  std::uint64_t count = 0, hits = 0;
  std::uint64_t different = 0;      ///< answers that are not the CPU's, bit for bit: a defect;
                                    ///< those of either hierarchy
  std::vector<DeviceStage> stages;  ///< copies between host and device apart: "copy: ..."
  double device_ms = 0;             ///< the stages' sum without copies: without the gaps between
                                    ///< them, and each with the launch before it
  double trace_ms = 0;              ///< of that, without the hierarchy: keys to hits
  double keys_to_hits_ms = 0;       ///< keys to hits by one pair of events, gaps and all, where
                                    ///< rays, hierarchy and hits lie on the device
  double call_ms = 0;               ///< the whole call as the host sees it, with copies, without
                                    ///< events
  double frame_ms = 0;              ///< the call, and all triangles to the device before
  std::vector<DeviceStage> refit_stages;  ///< the hierarchy's where it is refitted
  double refit_ms = 0;                    ///< their sum
  double refit_frame_ms = 0;              ///< as `frame_ms`, where it is refitted
  double cpu_ms = 0;  ///< the same query on the CPU, the hierarchy built anew too
};

struct DeviceBenchReport {
  std::string device;
  std::uint32_t threads = 0;  ///< of the CPU
  std::uint64_t triangles = 0;
  double copy_gb_per_s = 0;  ///< read and written, within the device's memory
  double gigaops_per_s = 0;  ///< multiplications and additions in binary32, not contracted
  /// Whether its kernels may follow pointers to pageable memory of the host's: one that a kernel
  /// was given by mistake then shows in no answer.
  bool reads_host_memory = false;
  std::vector<DeviceBenchBatch> batches;
};

/// Shadow rays ask for any hit, all others for the closest, by `dual`. Throws `Error`: kUnsupported
/// where there is no device, in CUDA's words; kInvalidArgument for the options; as `Laboratory`.
[[nodiscard]] DeviceBenchReport bench_device(const SceneDescription& scene,
                                             const DeviceBenchOptions& options = {});

/// How one kind of rays walks down the device's object tree: sums over all of them.
struct DeviceWalks {
  LabRays rays = LabRays::kShadow;
  std::uint64_t count = 0, hits = 0;
  std::uint64_t nodes = 0;      ///< visited, of two boxes each
  std::uint64_t leaves = 0;     ///< visited
  std::uint64_t triangles = 0;  ///< tested
  /// Turns of the loop over nodes and leaves. The threads of a warp, one a ray, wait for the one
  /// that turns most often: of each 32 rays in a row the most turns, summed.
  std::uint64_t warp_turns = 0;
  std::uint64_t sorted_warp_turns = 0;  ///< where rays are sorted before, as queries do

  [[nodiscard]] std::uint64_t warps() const { return (count + 31) / 32; }
};

struct DeviceWalksReport {
  std::uint64_t triangles = 0;
  std::vector<DeviceWalks> batches;
};

/// Counts on the CPU, by the device's own functions: no device is needed, and the same rays give
/// the same numbers on every machine. `DeviceBenchOptions::runs` does not matter. Throws `Error` as
/// `Laboratory`.
[[nodiscard]] DeviceWalksReport count_device_walks(const SceneDescription& scene,
                                                   const DeviceBenchOptions& options = {});

}  // namespace raysheaf
