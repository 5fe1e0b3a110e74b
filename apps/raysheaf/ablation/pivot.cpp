#include "ablation/pivot.h"

#include <fmt/format.h>

#include <algorithm>

#include "plot/svg.h"
#include "table.h"

namespace raysheaf::app {
namespace {

using Name = std::pair<std::string, std::string>;

std::size_t column_of(const std::string& name, Pivot* pivot) {
  const auto found = std::find(pivot->columns.begin(), pivot->columns.end(), name);
  if (found != pivot->columns.end()) return std::size_t(found - pivot->columns.begin());
  pivot->columns.push_back(name);
  return pivot->columns.size() - 1;
}

Pivot::Line& line_of(const Name& name, Pivot* pivot) {
  for (Pivot::Line& line : pivot->lines)
    if (line.name == name.first && line.detail == name.second) return line;
  pivot->lines.push_back({name.first, name.second, {}});
  return pivot->lines.back();
}

template <typename LineName, typename ColumnName>
Pivot pivot_of(const AblationReport& report, const std::string& scene, LabRays rays,
               const RowFigure& figure, LineName line_name, ColumnName column_name) {
  Pivot pivot;
  pivot.scene = scene;
  pivot.rays = rays;
  const RowTest here = of(scene, rays);
  for (const AblationRow& row : report.rows) {
    if (!here(row)) continue;
    const std::size_t column = column_of(column_name(row), &pivot);
    Pivot::Line& line = line_of(line_name(row), &pivot);
    if (line.cells.size() <= column) line.cells.resize(column + 1);
    const AblationRow*& cell = line.cells[column];
    if (cell == nullptr || figure(row) < figure(*cell)) cell = &row;
    if (pivot.least == nullptr || figure(row) < figure(*pivot.least)) pivot.least = &row;
  }
  for (Pivot::Line& line : pivot.lines) line.cells.resize(pivot.columns.size());
  return pivot;
}

std::string bits_text(const MethodSettings& s) {
  return comes_in_both_widths(s.key) ? fmt::format("{} bits", s.key_bits) : "";
}

}  // namespace

double percent_of(const AblationRow& row) {
  return row.percent();
}
double milliseconds_of(const AblationRow& row) {
  return row.total_ms();
}

Pivot key_pivot(const AblationReport& report, const std::string& scene, LabRays rays,
                const RowFigure& figure) {
  return pivot_of(
      report, scene, rays, figure,
      [](const AblationRow& r) { return Name(to_string(r.settings.key), bits_text(r.settings)); },
      [](const AblationRow& r) { return std::string(to_string(r.settings.bound)); });
}

Pivot tree_pivot(const AblationReport& report, const std::string& scene, LabRays rays,
                 const RowFigure& figure) {
  const bool both = report.command.mesh_culling.size() > 1;
  return pivot_of(
      report, scene, rays, figure,
      [both](const AblationRow& r) {
        const char* culling = r.settings.mesh_culling ? "meshes culled" : "no culling";
        const std::string levels = count_text(r.settings.levels, "level", "levels");
        return both ? Name(culling, levels) : Name(levels, "");
      },
      [](const AblationRow& r) { return "branching " + std::to_string(r.settings.branching); });
}

std::vector<std::pair<std::string, LabRays>> batches_of(const AblationReport& report) {
  std::vector<std::pair<std::string, LabRays>> all;
  for (const AblationRow& row : report.rows) {
    const auto batch = std::make_pair(row.scene, row.rays);
    if (all.empty() || all.back() != batch) all.push_back(batch);
  }
  return all;
}

bool has_several_trees(const AblationReport& report) {
  const BenchAblationCommand& c = report.command;
  return c.levels.size() * c.branching.size() * c.mesh_culling.size() > 1;
}

std::string key_text(const MethodSettings& settings) {
  const std::string bits = bits_text(settings);
  return std::string(to_string(settings.key)) + (bits.empty() ? "" : ", " + bits);
}

std::string rays_text(LabRays rays) {
  switch (rays) {
    case LabRays::kShadow:
      return "shadow rays";
    case LabRays::kReflection1:
      return "reflections, bounce 1";
    case LabRays::kReflection2:
      return "reflections, bounce 2";
    case LabRays::kAmbientOcclusion:
      break;
  }
  return "ambient occlusion";
}

std::string trees_text(const AblationReport& report) {
  const BenchAblationCommand& c = report.command;
  if (has_several_trees(report)) return "the smallest over levels, branching and mesh culling";
  return fmt::format("{}, branching {}, {} mesh culling",
                     count_text(c.levels.front(), "level", "levels"), c.branching.front(),
                     c.mesh_culling.front() ? "with" : "without");
}

std::string pivot_text(const Pivot& pivot, const RowFigure& figure) {
  std::vector<std::string> heading{"", ""};
  for (const std::string& column : pivot.columns) heading.push_back(fmt::format("{:>12} ", column));
  Table table(heading);
  for (const Pivot::Line& line : pivot.lines) {
    std::vector<std::string> cells{line.name, line.detail};
    for (const AblationRow* cell : line.cells)
      cells.push_back(fmt::format("{:>12}{}", cell == nullptr ? "" : three_digits(figure(*cell)),
                                  cell != nullptr && cell == pivot.least ? '*' : ' '));
    table.add(cells);
  }
  return table.text();
}

std::string pivot_markdown(const Pivot& pivot, const RowFigure& figure) {
  std::string text = "| |", rule = "\n|---|";
  for (const std::string& column : pivot.columns) {
    text += " " + column + " |";
    rule += "---:|";
  }
  text += rule + "\n";
  for (const Pivot::Line& line : pivot.lines) {
    text += "| " + line.name + (line.detail.empty() ? "" : ", " + line.detail) + " |";
    for (const AblationRow* cell : line.cells) {
      const std::string number = cell == nullptr ? "" : three_digits(figure(*cell));
      text +=
          cell != nullptr && cell == pivot.least ? " **" + number + "** |" : " " + number + " |";
    }
    text += "\n";
  }
  return text;
}

}  // namespace raysheaf::app
