// `raysheaf bench scale`: measures streamed frames. tools/pages fits a model to them and predicts
// others.
#pragma once

#include <string>
#include <vector>

#include "lab/commands/commands.h"
#include "lab/commands/scale/ranks.h"

namespace raysheaf::app {

/// Where the time of a frame went, in seconds of one core, which never waits.
struct ScaleCost {
  double decode_s = 0;   ///< blocks: from the system's cache to validated triangles
  double cull_s = 0;     ///< the tree over the rays, and culling blocks against it
  double trace_s = 0;    ///< blocks against their rays
  double shading_s = 0;  ///< surfaces of the hits, and reading the shading data of their blocks
  double rest_s = 0;     ///< making and ordering rays, adding up light
  double bytes = 0;      ///< read from the file
};

/// A measured frame.
struct ScaleSample {
  double triangles = 0, pixels = 0, rays = 0;  ///< rays: of all batches
  std::uint64_t blocks = 0, read_blocks = 0;   ///< of all batches
  std::uint32_t batches = 0;
  double seconds = 0;  ///< of wall time
  ScaleCost cost;
};

struct ScaleReport {
  BenchScaleCommand asked;
  std::uint32_t threads = 0;
  double geometry_bytes = 0, shading_bytes = 0;  ///< per triangle
  /// a part p of the rays reads the part p^sharing of the bytes that all of them read
  double sharing = 1;
  std::vector<ScaleSample> samples;  ///< on one thread
  ScaleSample together;              ///< the last of them on all threads
  ScaleSample check;                 ///< another frame, on all threads
  std::vector<RankRun> rank_runs;    ///< that frame rendered by several processes
  std::string no_rank_runs;          ///< why `rank_runs` is empty
};

/// Generates halls into a folder of its own, which it removes afterwards, and renders them.
[[nodiscard]] ScaleReport measure_scale(const BenchScaleCommand& command, const Tell& tell);

[[nodiscard]] std::string scale_text(const ScaleReport& report);
[[nodiscard]] std::string scale_json(const ScaleReport& report);

}  // namespace raysheaf::app
