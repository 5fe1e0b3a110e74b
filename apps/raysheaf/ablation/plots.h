// The ablation's figures as pictures.
#pragma once

#include <string>

#include "ablation/ablation.h"

namespace raysheaf::app {

/// Keys by bounds, a heat map a kind of rays; then levels by branching, where they vary.
[[nodiscard]] std::string ablation_tests_svg(const AblationReport& report,
                                             const std::string& scene);
/// Tests against time, a scatter plot a kind of rays.
[[nodiscard]] std::string ablation_time_svg(const AblationReport& report, const std::string& scene);

/// FILE-SCENE-tests.svg or FILE-SCENE-time.svg for FILE.svg; a scene's odd letters become '-'.
[[nodiscard]] std::string plot_path(const std::string& svg_path, const std::string& scene,
                                    const std::string& what);

}  // namespace raysheaf::app
