// The time of a streamed frame, as a sum of resources that each grow linearly: fitted to measured
// frames, and extrapolated to sizes and machines that are not available.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace raysheaf::app {

/// A measured frame, or the prediction for one. Seconds are those of one core, which never waits.
struct ScaleCost {
  double decode_s = 0;   ///< blocks: from the system's cache to validated triangles
  double cull_s = 0;     ///< the tree over the rays, and culling blocks against it
  double trace_s = 0;    ///< blocks against their rays
  double shading_s = 0;  ///< surfaces of the hits, and reading the shading data of their blocks
  double rest_s = 0;     ///< making and ordering rays, adding up light
  double bytes = 0;      ///< read from the file

  [[nodiscard]] double core_s() const { return decode_s + cull_s + trace_s + shading_s + rest_s; }
};

struct ScaleSample {
  double triangles = 0, pixels = 0, rays = 0;  ///< rays: of all batches
  std::uint64_t blocks = 0, read_blocks = 0;   ///< of all batches
  std::uint32_t batches = 0;
  double seconds = 0;  ///< of wall time
  ScaleCost cost;
};

/// Each field of a cost as c0 + c1 * triangles + c2 * pixels, with no negative coefficient.
class ScaleModel {
 public:
  /// Needs samples of at least two numbers of triangles and two of pixels.
  explicit ScaleModel(const std::vector<ScaleSample>& samples);

  [[nodiscard]] ScaleCost cost(double triangles, double pixels) const;
  /// c0, c1, c2.
  [[nodiscard]] std::array<double, 3> coefficients(double ScaleCost::*field) const;

 private:
  static constexpr std::size_t kFields = 6;
  std::array<std::array<double, 3>, kFields> fits_{};
};

/// The machines of a prediction.
struct ScaleMachines {
  std::uint32_t ranks = 1;
  double cores = 2;                 ///< of each rank
  double serial = 0;                ///< the part of a rank's work that only one core does
  double disk_bytes_s = 2e9;        ///< of each rank
  double network_bytes_s = 1.25e9;  ///< of each rank, in each direction
  double latency_s = 20e-6;
};

/// Bytes of a streamed hit that is sent between ranks.
inline constexpr double kHitBytes = 84;

/// The time of work on all cores of a rank (G. Amdahl 1967).
[[nodiscard]] inline double clock_seconds(double core_s, const ScaleMachines& machines) {
  return core_s * (machines.serial + (1 - machines.serial) / machines.cores);
}
/// The `serial` that explains `seconds` on that number of cores.
[[nodiscard]] double serial_part(double core_s, double seconds, double cores);

struct ScaleForecast {
  double disk_s = 0, compute_s = 0, network_s = 0, total_s = 0;
  const char* bound_by = "";  ///< "disk", "cores" or "network"
};

/// Every rank streams its part of the blocks past all rays, then hits are combined: `batches` ring
/// reductions of one hit per ray.
[[nodiscard]] ScaleForecast forecast_geometry(const ScaleModel& model, double triangles,
                                              double pixels, double batches,
                                              const ScaleMachines& machines);

/// Every rank has a part of the rays, and streams the blocks that those may hit. `sharing`: a rank
/// with a part p of the rays reads the part p^sharing of the bytes that all of them read.
[[nodiscard]] ScaleForecast forecast_rays(const ScaleModel& model, double triangles, double pixels,
                                          double sharing, const ScaleMachines& machines);

}  // namespace raysheaf::app
