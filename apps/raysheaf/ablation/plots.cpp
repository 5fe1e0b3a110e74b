#include "ablation/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string_view>

#include "ablation/pivot.h"
#include "console.h"
#include "plot/plots.h"
#include "plot/svg.h"

namespace raysheaf::app {
namespace {

constexpr std::string_view kFamilies[] = {
    "pixel order", "published hashes",     "key crsh",       "direction",
    "end point",   "direction and origin", "origin and exit"};

std::size_t family_of(RayKey key) {
  const auto* const at =
      std::find(std::begin(kFamilies), std::end(kFamilies), std::string_view(words_of(key).family));
  return static_cast<std::size_t>(at - std::begin(kFamilies));
}

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

HeatMap heat_map(const Pivot& pivot, const std::string& title) {
  HeatMap map;
  map.title = title;
  map.note = fmt::format("Least: {} %, {}, {}", three_digits(pivot.least->percent()),
                         key_text(pivot.least->settings), to_string(pivot.least->settings.bound));
  map.columns = pivot.columns;
  for (const Pivot::Line& line : pivot.lines) {
    HeatMap::Row row{line.name, line.detail, {}};
    for (const AblationRow* cell : line.cells)
      row.values.push_back(cell == nullptr ? 0 : cell->percent());
    map.rows.push_back(std::move(row));
  }
  return map;
}

std::string short_label(const MethodSettings& s) {
  const std::string bits = comes_in_both_widths(s.key) ? fmt::format(" {}", s.key_bits) : "";
  return fmt::format("{}{} · {}", to_string(s.key), bits, to_string(s.bound));
}

/// The settings of method `crsh`, if they were measured.
bool is_crsh(const AblationRow& row) {
  return row.settings.key == RayKey::kCrsh && row.settings.bound == BundleBound::kSphereCone;
}

Scatter scatter(const AblationReport& report, const std::string& scene, LabRays rays) {
  Scatter plot;
  plot.title = capital(rays_text(rays));
  const RowTest here = of(scene, rays);
  const AblationRow* fewest = fewest_tests(report, here);
  const AblationRow* quickest = least_time(report, here);
  const AblationRow* crsh =
      least_time(report, [&](const AblationRow& row) { return here(row) && is_crsh(row); });
  const std::vector<BundleBound>& bounds = report.command.bounds;
  for (const AblationRow& row : report.rows) {
    if (!here(row) || row.counts.total_tests() == 0) continue;
    Scatter::Point p;
    p.x = row.percent();
    p.y = std::max(row.total_ms(), 1e-3);
    p.color = static_cast<std::size_t>(std::find(bounds.begin(), bounds.end(), row.settings.bound) -
                                       bounds.begin());
    p.shape = family_of(row.settings.key);
    if (&row == fewest || &row == quickest || &row == crsh) p.label = short_label(row.settings);
    plot.points.push_back(std::move(p));
  }
  return plot;
}

std::string size_text(const AblationReport& report) {
  return fmt::format("{}x{} pixels", report.command.width, report.command.height);
}

}  // namespace

std::string ablation_tests_svg(const AblationReport& report, const std::string& scene) {
  std::vector<HeatMap> maps;
  for (const auto& [name, rays] : batches_of(report))
    if (name == scene)
      maps.push_back(
          heat_map(key_pivot(report, scene, rays, percent_of), capital(rays_text(rays))));
  if (has_several_trees(report)) {
    for (const auto& [name, rays] : batches_of(report))
      if (name == scene)
        maps.push_back(heat_map(tree_pivot(report, scene, rays, percent_of),
                                capital(rays_text(rays)) + ": the hierarchy"));
  }
  return heat_maps_svg(capital(printable(scene)) + ": tests by key and bound",
                       "Percentage of brute force, " + size_text(report) + ", " +
                           trees_text(report) +
                           ". Darker cells are smaller; each plot has its own scale.",
                       maps);
}

std::string ablation_time_svg(const AblationReport& report, const std::string& scene) {
  ScatterKey key{"tests, % of brute force", "order, hierarchy and trace, ms", {}, {}};
  for (const BundleBound bound : report.command.bounds) key.colors.emplace_back(to_string(bound));
  for (const std::string_view family : kFamilies) key.shapes.emplace_back(family);
  const std::string trees = has_several_trees(report)
                                ? "all levels, branchings and kinds of mesh culling"
                                : trees_text(report);
  std::vector<Scatter> plots;
  for (const auto& [name, rays] : batches_of(report))
    if (name == scene) plots.push_back(scatter(report, scene, rays));
  return scatters_svg(capital(printable(scene)) + ": tests against time",
                      size_text(report) +
                          ". Colours stand for bounds, shapes for the parts of the key. Lower and "
                          "farther left is better.",
                      key, plots);
}

std::string plot_path(const std::string& svg_path, const std::string& scene,
                      const std::string& what) {
  std::string name = scene;
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) == 0 && c != '_' && byte < 0x80) c = '-';
  }
  return svg_path.substr(0, svg_path.size() - 4) + "-" + name + "-" + what + ".svg";
}

}  // namespace raysheaf::app
