// The comparison as SVG.
#pragma once

#include <string>

#include "compare/compare.h"

namespace raysheaf::app {

/// A panel per mode: scenes by row, ratios along a logarithmic axis, a dot per kind of rays.
[[nodiscard]] std::string compare_svg(const CompareReport& report);

/// A panel for each growth, mode and kind: time against count, both logarithmic, for the library,
/// the peer, and linear growth.
[[nodiscard]] std::string growth_svg(const CompareReport& report);

/// The steepest growth between two consecutive points: the exponent p of time ~ count^p; 1 is
/// linear. 0 with fewer than two points. `theirs` uses the times of the peer.
[[nodiscard]] double steepest(const std::vector<const CompareCase*>& line, const std::string& along,
                              bool theirs);

/// The points of the growth along "rays" or "triangles", in one mode, for one kind.
[[nodiscard]] std::vector<const CompareCase*> growth_line(const CompareReport& report,
                                                          const std::string& along,
                                                          CompareMode mode, CompareKind kind);

}  // namespace raysheaf::app
