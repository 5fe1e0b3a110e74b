// What a report tells, gathered: every method run on the scene, its picture, counts and times.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "options.h"
#include "raysheaf/render.h"

namespace raysheaf::app {

/// One method. `counted` comes from a run that counts for every pixel and measures bundles,
/// `times` from a run that does neither; the counts of both are the same.
struct MethodReport {
  Method method = Method::kDual;
  bool ran = true;  ///< false: of `brute` alone, whose tests are known without a run
  FrameStatistics counted, times;
  std::vector<float> tests;  ///< a pixel; empty where it did not run
};

struct Report {
  RenderResult picture;  ///< of the first method that ran
  double load_ms = 0;
  std::uint32_t branching = 8;        ///< of the ray hierarchy
  std::vector<MethodReport> methods;  ///< as `Method` names them
};

/// Bundles that are measured of each level of a batch.
inline constexpr std::uint32_t kBundleSamples = 256;

/// Where nobody asked for it by name, `brute` runs up to this many tests.
inline constexpr std::uint64_t kMostBruteForceTests = 4'000'000'000;

/// Runs `command.methods`, or all there are. Throws what `render` throws, and `Error` (kInternal)
/// where two methods give different pictures. `stage` is told what is going on.
[[nodiscard]] Report measure(const SceneDescription& scene, const ReportCommand& command,
                             const std::function<bool(const Progress&)>& progress);

}  // namespace raysheaf::app
