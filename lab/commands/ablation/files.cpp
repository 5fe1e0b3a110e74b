#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/support/table.h"
#include "lab/commands/ablation/ablation.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

Json levels_json(const AblationRow& row) {
  Json all = Json::array();
  for (const LevelStatistics& l : row.counts.levels)
    all.push_back(
        {{"level", l.level}, {"tests", l.tests}, {"hits", l.hits}, {"misses", l.misses()}});
  return all;
}

Json row_json(const AblationRow& row) {
  const MethodSettings& s = row.settings;
  const BatchStatistics& c = row.counts;
  return {{"scene", row.scene},
          {"batch", to_string(row.rays)},
          {"key", to_string(s.key)},
          {"key_bits", comes_in_both_widths(s.key) ? Json(s.key_bits) : Json(nullptr)},
          {"bound", to_string(s.bound)},
          {"levels", s.levels},
          {"branching", s.branching},
          {"mesh_culling", s.mesh_culling},
          {"rays", c.rays},
          {"triangles", c.triangles},
          {"chunks", c.chunks},
          {"per_level", levels_json(row)},
          {"final_tests", c.final_tests},
          {"mesh_sphere_tests", c.mesh_sphere_tests},
          {"total", c.total_tests()},
          {"brute_force", c.brute_force_tests()},
          {"relative", c.relative()},
          {"times_ms",
           {{"order", c.times_ms.order},
            {"hierarchy", c.times_ms.hierarchy},
            {"trace", row.trace_ms()},
            {"total", row.total_ms()}}}};
}

/// A line for each key and hierarchy, a column for each bound, which changes fastest among the
/// rows.
std::string batch_text(const AblationReport& report, const std::string& scene, LabRays rays) {
  const AblationRow *fewest = fewest_tests(report, scene, rays),
                    *quickest = least_time(report, scene, rays);
  if (fewest == nullptr) return "";
  std::vector<std::string> heading{"key", "bits", "levels x branching"}, line;
  for (const BundleBound bound : report.command.bounds) heading.emplace_back(to_string(bound));
  Table table(heading);
  for (const AblationRow& row : report.rows) {
    if (!row.is_of(scene, rays)) continue;
    const MethodSettings& s = row.settings;
    if (line.empty())
      line = {to_string(s.key), comes_in_both_widths(s.key) ? std::to_string(s.key_bits) : "",
              fmt::format("{}x{}{}", s.levels, s.branching, s.mesh_culling ? "" : ", no culling")};
    line.push_back(fmt::format("{}{} / {}{}", three_digits(row.percent()),
                               &row == fewest ? "*" : "", three_digits(row.total_ms()),
                               &row == quickest ? "*" : ""));
    if (line.size() < heading.size()) continue;
    table.add(std::move(line));
    line.clear();
  }
  return fmt::format("{}, {}: {} rays, {} triangles\n{}\n", scene, to_string(rays),
                     fewest->counts.rays, fewest->counts.triangles, table.text());
}

}  // namespace

std::string ablation_json(const AblationReport& report) {
  const BenchAblationCommand& c = report.command;
  Json all = {{"command", c.words},        {"size", fmt::format("{}x{}", c.width, c.height)},
              {"threads", c.threads},      {"repeat", c.repeat},
              {"scenes", report.scenes},   {"families", Json::object()},
              {"reasons", Json::object()}, {"results", Json::array()},
              {"best", Json::array()}};
  for (const RayKey key : c.keys) {
    all["families"][to_string(key)] = words_of(key).family;
    all["reasons"][to_string(key)] = words_of(key).reason;
  }
  for (const BundleBound bound : c.bounds) all["reasons"][to_string(bound)] = reason_of(bound);
  for (const AblationRow& row : report.rows) all["results"].push_back(row_json(row));
  for (const std::string& scene : report.scenes) {
    for (const LabRays rays : c.rays) {
      const AblationRow* fewest = fewest_tests(report, scene, rays);
      if (fewest == nullptr) continue;
      all["best"].push_back({{"scene", scene},
                             {"batch", to_string(rays)},
                             {"fewest_tests", row_json(*fewest)},
                             {"least_time", row_json(*least_time(report, scene, rays))}});
    }
  }
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ablation_csv(const AblationReport& report) {
  std::string text =
      "scene,batch,key,key_bits,bound,levels,branching,mesh_culling,rays,triangles,total,"
      "brute_force,percent,final_tests,mesh_sphere_tests,order_ms,hierarchy_ms,trace_ms,total_ms\n";
  for (const AblationRow& row : report.rows) {
    const MethodSettings& s = row.settings;
    const BatchStatistics& c = row.counts;
    text += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{:.6g},{},{},{:.3f},{:.3f},{:.3f},{:.3f}\n",
        csv_field(row.scene), to_string(row.rays), to_string(s.key),
        comes_in_both_widths(s.key) ? std::to_string(s.key_bits) : "", to_string(s.bound), s.levels,
        s.branching, s.mesh_culling ? "on" : "off", c.rays, c.triangles, c.total_tests(),
        c.brute_force_tests(), row.percent(), c.final_tests, c.mesh_sphere_tests, c.times_ms.order,
        c.times_ms.hierarchy, row.trace_ms(), row.total_ms());
  }
  return text;
}

std::string ablation_text(const AblationReport& report) {
  std::string text;
  for (const std::string& scene : report.scenes)
    for (const LabRays rays : report.command.rays) text += batch_text(report, scene, rays);
  if (text.empty()) return "the scenes have no rays of these kinds\n";
  return text +
         "tests as a percentage of brute force / milliseconds for order, hierarchy and trace; * "
         "marks "
         "the least of a table\n";
}

}  // namespace raysheaf::app
