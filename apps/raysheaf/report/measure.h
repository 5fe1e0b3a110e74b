// Gathers the data of a report: runs every method on the scene, with images, counts and times.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "options.h"
#include "raysheaf/render.h"

namespace raysheaf::app {

/// One method. `counted` comes from a run that counts tests for every pixel and measures bundles,
/// `times` from a run without both; the counts of both runs are the same.
struct MethodReport {
  Method method = Method::kDual;
  bool ran = true;  ///< false only for `brute`, whose tests are known without running it
  FrameStatistics counted, times;
  std::vector<float> tests;  ///< per pixel; empty if the method did not run
};

struct Report {
  RenderResult picture;  ///< of the first method that ran
  double load_ms = 0;
  std::uint32_t branching = 8;        ///< of the ray hierarchy
  std::vector<MethodReport> methods;  ///< in the order of `Method`
};

/// The number of bundles that are measured in each level of a batch.
inline constexpr std::uint32_t kBundleSamples = 256;

/// Unless it was requested by name, `brute` runs only up to this number of tests.
inline constexpr std::uint64_t kMostBruteForceTests = 4'000'000'000;

/// Runs `command.methods`, or all methods. Throws as `render` does, and `Error` (kInternal) if two
/// methods give different images. `stage` is called with the name of each step.
[[nodiscard]] Report measure(const SceneDescription& scene, const ReportCommand& command,
                             const std::function<bool(const Progress&)>& progress);

}  // namespace raysheaf::app
