#include "ablation/files.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "ablation/pivot.h"

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

/// In quotes if it contains a comma or a quote.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string ablation_json(const AblationReport& report) {
  Json all = {{"results", Json::array()}, {"best", Json::array()}};
  for (const AblationRow& row : report.rows) all["results"].push_back(row_json(row));
  for (const auto& [scene, rays] : batches_of(report)) {
    all["best"].push_back({{"scene", scene},
                           {"batch", to_string(rays)},
                           {"fewest_tests", row_json(*fewest_tests(report, of(scene, rays)))},
                           {"least_time", row_json(*least_time(report, of(scene, rays)))}});
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

}  // namespace raysheaf::app
