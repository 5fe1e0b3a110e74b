// The comparison as SVG.
#pragma once

#include <string>

#include "compare/compare.h"

namespace raysheaf::app {

/// A panel a mode: scenes down, ratios across on a logarithmic scale, a dot a kind of rays.
[[nodiscard]] std::string compare_svg(const CompareReport& report);

/// A panel for what grows in each mode and kind: time against it, both logarithmic; ours and
/// theirs, and what linear growth would be.
[[nodiscard]] std::string growth_svg(const CompareReport& report);

/// The steepest growth between two points in a row: the exponent p of time ~ count^p; 1 is linear.
/// 0 where there are fewer than two points. `theirs` takes the peer's times.
[[nodiscard]] double steepest(const std::vector<const CompareCase*>& line, const std::string& along,
                              bool theirs);

/// The points of the growth along one thing, in one mode, of one kind.
[[nodiscard]] std::vector<const CompareCase*> growth_line(const CompareReport& report,
                                                          const std::string& along,
                                                          CompareMode mode, CompareKind kind);

}  // namespace raysheaf::app
