#include <nlohmann/json.hpp>

#include "paper/combinations.h"
#include "paper/json.h"
#include "paper/sheets.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(const std::optional<std::uint64_t>& count) {
  return count ? Json(*count) : Json(nullptr);
}

Json levels_json(const std::vector<LevelStatistics>& levels) {
  Json all = Json::array();
  for (const LevelStatistics& l : levels)
    all.push_back(
        {{"level", l.level}, {"tests", l.tests}, {"hits", l.hits}, {"misses", l.misses()}});
  return all;
}

Json published_json(const PublishedTable* table) {
  if (table == nullptr) return nullptr;
  Json levels = Json::array();
  for (const PublishedLevel& l : table->levels) {
    const bool both = l.tests.value && l.hits.value;
    levels.push_back({{"level", l.level},
                      {"tests", or_null(l.tests.value)},
                      {"hits", or_null(l.hits.value)},
                      {"misses", both ? Json(*l.tests.value - *l.hits.value) : Json(nullptr)}});
  }
  return {{"total", table->total}, {"levels", std::move(levels)}};
}

Json times_json(const Measured& m) {
  if (!m.timed) return Json::object();
  const StageTimes& t = m.counts.times_ms;
  return {{"raygen", t.raygen},
          {"order", t.order},
          {"hierarchy", t.hierarchy},
          {"traverse", t.traverse},
          {"intersect", t.intersect}};
}

Json result_json(const Measured& m) {
  const BatchStatistics& c = m.counts;
  return {{"scene", m.scene},
          {"method", to_string(m.method)},
          {"kind", to_string(c.kind)},
          {"bounce", c.bounce},
          {"rays", c.rays},
          {"triangles", c.triangles},
          {"levels", levels_json(c.levels)},
          {"bound_tests", c.bound_tests},
          {"ray_bound_tests", c.ray_bound_tests},
          {"final_tests", c.final_tests},
          {"mesh_sphere_tests", c.mesh_sphere_tests},
          {"total", c.total_tests()},
          {"brute_force", c.brute_force_tests()},
          {"relative", c.relative()},
          {"paper", published_json(m.published)},
          {"plan", c.plan},
          {"times_ms", times_json(m)}};
}

Json total_json(const SceneTotal& t) {
  return {
      {"scene", t.scene},
      {"method", to_string(t.method)},
      {"total", t.total},
      {"brute_force", t.brute_force},
      {"relative", t.relative()},
      {"paper_relative", t.published_total != 0 ? Json(t.published_relative()) : Json(nullptr)}};
}

Json combination_json(const Combination& c) {
  Json tables = Json::array();
  for (const Measured& m : c.tables)
    tables.push_back({{"scene", m.scene},
                      {"kind", to_string(m.counts.kind)},
                      {"rays", m.counts.rays},
                      {"levels", levels_json(m.counts.levels)},
                      {"final_tests", m.counts.final_tests},
                      {"total", m.counts.total_tests()},
                      {"paper", published_json(m.published)}});
  return {{"method", to_string(c.method)},
          {"combination", name_of(c.quirks)},
          {"dropped_rays", c.quirks.dropped_rays},
          {"deviation", c.deviation},
          {"tables", std::move(tables)}};
}

}  // namespace

std::string paper_json(const PaperReport& report) {
  Json all = {{"results", Json::array()}, {"totals", Json::array()}};
  for (const Measured& m : report.batches) all["results"].push_back(result_json(m));
  for (const SceneTotal& t : scene_totals(report.tables)) all["totals"].push_back(total_json(t));
  if (!report.combinations.empty()) {
    Json& list = all["as_published"] = Json::array();
    for (const auto* part : {&report.combinations, &report.phases})
      for (const Combination& c : *part) list.push_back(combination_json(c));
  }
  return all.dump(2) + "\n";
}

}  // namespace raysheaf::app
