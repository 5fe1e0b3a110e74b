// `raysheaf bench scale`: streamed frames measured, a model fitted to them, and what it says.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "options.h"
#include "scale/model.h"
#include "scale/ranks.h"

namespace raysheaf::app {

struct ScaleReport {
  BenchScaleCommand asked;
  std::uint32_t threads = 0;
  double geometry_bytes = 0, shading_bytes = 0;  ///< a triangle
  double sharing = 1;                            ///< as `forecast_rays` has it
  std::vector<ScaleSample> samples;              ///< the model's, on one thread
  ScaleSample together;                          ///< the last of them again, on all threads
  ScaleSample check;                             ///< a frame that it has not seen, on all threads
  std::vector<RankRun> rank_runs;                ///< that frame again, by processes
  std::string no_rank_runs;                      ///< why there are none
};

/// Generates halls into a folder of its own, which is gone afterwards, and renders them. Calls
/// `progress(done, total)` between frames; what it throws ends the run.
[[nodiscard]] ScaleReport measure_scale(
    const BenchScaleCommand& command,
    const std::function<void(std::uint64_t, std::uint64_t)>& progress);

[[nodiscard]] std::string scale_text(const ScaleReport& report);
[[nodiscard]] std::string scale_page(const ScaleReport& report);
[[nodiscard]] std::string scale_json(const ScaleReport& report);

}  // namespace raysheaf::app
