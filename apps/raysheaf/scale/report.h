// `raysheaf bench scale`: measures streamed frames, fits a model to them, and predicts others.
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
  double geometry_bytes = 0, shading_bytes = 0;  ///< per triangle
  double sharing = 1;                            ///< as in `forecast_rays`
  std::vector<ScaleSample> samples;              ///< the samples of the model, on one thread
  ScaleSample together;                          ///< the last of them on all threads
  ScaleSample check;               ///< a frame that the model was not fitted to, on all threads
  std::vector<RankRun> rank_runs;  ///< that frame rendered by several processes
  std::string no_rank_runs;        ///< why `rank_runs` is empty
};

/// Generates halls into a folder of its own, which it removes afterwards, and renders them. Calls
/// `progress(done, total)` between frames; an exception from it ends the run.
[[nodiscard]] ScaleReport measure_scale(
    const BenchScaleCommand& command,
    const std::function<void(std::uint64_t, std::uint64_t)>& progress);

[[nodiscard]] std::string scale_text(const ScaleReport& report);
[[nodiscard]] std::string scale_page(const ScaleReport& report);
[[nodiscard]] std::string scale_json(const ScaleReport& report);

}  // namespace raysheaf::app
