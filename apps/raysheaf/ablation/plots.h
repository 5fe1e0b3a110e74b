// The figures of the ablation as plots.
#pragma once

#include <string>

#include "ablation/ablation.h"

namespace raysheaf::app {

/// Heat maps of keys by bounds, one for each kind of rays; then of levels by branching, if they
/// vary.
[[nodiscard]] std::string ablation_tests_svg(const AblationReport& report,
                                             const std::string& scene);
/// Scatter plots of tests against time, one for each kind of rays.
[[nodiscard]] std::string ablation_time_svg(const AblationReport& report, const std::string& scene);

/// FILE-SCENE-tests.svg or FILE-SCENE-time.svg for FILE.svg; unusual letters of the scene become
/// '-'.
[[nodiscard]] std::string plot_path(const std::string& svg_path, const std::string& scene,
                                    const std::string& what);

}  // namespace raysheaf::app
