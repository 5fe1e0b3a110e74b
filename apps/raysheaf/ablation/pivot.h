// The figures of the ablation as tables: one setting by row, another by column, each cell the
// smallest figure over all other settings.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ablation/ablation.h"

namespace raysheaf::app {

struct Pivot {
  struct Line {
    std::string name, detail;
    std::vector<const AblationRow*> cells;  ///< null: not measured
  };
  std::string scene;
  LabRays rays = LabRays::kShadow;
  std::vector<std::string> columns;
  std::vector<Line> lines;
  const AblationRow* least = nullptr;
};

using RowFigure = std::function<double(const AblationRow&)>;

[[nodiscard]] double percent_of(const AblationRow& row);
[[nodiscard]] double milliseconds_of(const AblationRow& row);

/// Keys down, bounds across.
[[nodiscard]] Pivot key_pivot(const AblationReport& report, const std::string& scene, LabRays rays,
                              const RowFigure& figure);
/// Levels down (with culling and without, where both were measured), branching across.
[[nodiscard]] Pivot tree_pivot(const AblationReport& report, const std::string& scene, LabRays rays,
                               const RowFigure& figure);

/// Scenes and rays that have rows, in the order of their measurement.
[[nodiscard]] std::vector<std::pair<std::string, LabRays>> batches_of(const AblationReport& report);

/// Whether more than one combination of levels, branching and culling was measured.
[[nodiscard]] bool has_several_trees(const AblationReport& report);

/// "octahedral-hilbert, 64 bits"
[[nodiscard]] std::string key_text(const MethodSettings& settings);
/// "shadow rays", "reflections, bounce 1", ...
[[nodiscard]] std::string rays_text(LabRays rays);
/// "2 levels, branching 8, with mesh culling", or a remark that they vary.
[[nodiscard]] std::string trees_text(const AblationReport& report);

[[nodiscard]] std::string pivot_text(const Pivot& pivot, const RowFigure& figure);
[[nodiscard]] std::string pivot_markdown(const Pivot& pivot, const RowFigure& figure);

}  // namespace raysheaf::app
