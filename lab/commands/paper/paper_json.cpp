#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lab/commands/paper/combinations.h"
#include "lab/commands/paper/paper.h"

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

Json or_null(const std::optional<double>& time) {
  return time ? Json(*time) : Json(nullptr);
}

Json published_json(const PublishedTable* table) {
  if (table == nullptr) return nullptr;
  Json levels = Json::array();
  for (const PublishedLevel& l : table->levels) {
    const bool both = l.tests.value && l.hits.value;
    levels.push_back({{"level", l.level},
                      {"tests", or_null(l.tests.value)},
                      {"tests_rounded", l.tests.rounded},
                      {"hits", or_null(l.hits.value)},
                      {"hits_rounded", l.hits.rounded},
                      {"misses", both ? Json(*l.tests.value - *l.hits.value) : Json(nullptr)}});
  }
  const PublishedTimes& t = table->times_ms;
  return {{"rays", table->rays},
          {"total", table->total},
          {"depth", table->depth},
          {"branching", table->branching},
          {"levels", std::move(levels)},
          {"times_ms",
           {{"raygen", or_null(t.raygen)},
            {"order", or_null(t.order)},
            {"hierarchy", or_null(t.hierarchy)},
            {"traverse", or_null(t.traverse)},
            {"intersect", or_null(t.intersect)}}}};
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

/// The figures that every table has.
Json table_json(const Measured& m) {
  const BatchStatistics& c = m.counts;
  return {{"scene", m.scene},
          {"method", to_string(m.method)},
          {"kind", to_string(c.kind)},
          {"bounce", c.bounce},
          {"rays", c.rays},
          {"levels", levels_json(c.levels)},
          {"final_tests", c.final_tests},
          {"total", c.total_tests()},
          {"paper", published_json(m.published)}};
}

Json result_json(const Measured& m) {
  const BatchStatistics& c = m.counts;
  Json result = table_json(m);
  result.update({{"triangles", c.triangles},
                 {"chunks", c.chunks},
                 {"hits", c.hits},
                 {"bound_tests", c.bound_tests},
                 {"ray_bound_tests", c.ray_bound_tests},
                 {"mesh_sphere_tests", c.mesh_sphere_tests},
                 {"brute_force", c.brute_force_tests()},
                 {"relative", c.relative()},
                 {"plan", c.plan},
                 {"times_ms", times_json(m)}});
  return result;
}

Json total_json(const SceneTotal& t) {
  const bool known = t.published_total != 0;
  return {{"scene", t.scene},
          {"method", to_string(t.method)},
          {"total", t.total},
          {"brute_force", t.brute_force},
          {"relative", t.relative()},
          {"paper_total", known ? Json(t.published_total) : Json(nullptr)},
          {"paper_relative", known ? Json(t.published_relative()) : Json(nullptr)}};
}

template <typename All, typename ToJson>
Json list_of(const All& all, ToJson to_json) {
  Json list = Json::array();
  for (const auto& one : all) list.push_back(to_json(one));
  return list;
}

Json combination_json(const Combination& c) {
  return {{"method", to_string(c.method)},
          {"combination", name_of(c.quirks)},
          {"dropped_rays", c.quirks.dropped_rays},
          {"deviation", c.deviation},
          {"tables", list_of(c.tables, table_json)}};
}

}  // namespace

std::string paper_json(const PaperReport& report) {
  Json all = {{"command", report.words},
              {"builtin", report.builtin},
              {"size", fmt::format("{}x{}", report.width, report.height)},
              {"checked", report.checked},
              {"scenes", report.scenes},
              {"methods", list_of(report.methods, [](Method m) { return to_string(m); })},
              {"results", list_of(report.batches, result_json)},
              {"tables", list_of(report.tables, result_json)},
              {"totals", list_of(scene_totals(report.tables), total_json)}};
  if (!report.combinations.empty()) {
    all["as_published"] = list_of(report.combinations, combination_json);
    all["phases"] = list_of(report.phases, combination_json);
    all["sweep"] = list_of(report.sweep, table_json);
  }
  return all.dump(2) + "\n";
}

}  // namespace raysheaf::app
