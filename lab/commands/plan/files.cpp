#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/support/console.h"
#include "apps/support/table.h"
#include "lab/commands/compare/compare.h"
#include "lab/commands/plan/plan.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

/// The geometric mean of the plan's time / the best choice's; where the plan is the best, 1.
double mean_loss(const PlanReport& report) {
  double sum = 0;
  for (const PlanCase& c : report.cases) sum += std::log(std::max(1.0, c.trial.best().loss));
  return report.cases.empty() ? 1 : std::exp(sum / static_cast<double>(report.cases.size()));
}

}  // namespace

std::uint64_t PlanReport::losing() const {
  return static_cast<std::uint64_t>(
      std::count_if(cases.begin(), cases.end(), [](const PlanCase& c) { return c.loses(); }));
}

std::string plan_text(const PlanReport& report) {
  std::string text = fmt::format(
      "the plan against every other choice, {} threads, medians of {} rounds; * is more than "
      "{:.0f} "
      "% slower\n",
      report.threads, report.command.runs, 100 * (kMostPlanLoss - 1));
  Table table({"scene", "triangles", "mode", "kind", "rays", "plan ms", "best ms", "plan / best",
               "best choice", "plan"});
  for (const PlanCase& c : report.cases) {
    const PlanWay& best = c.trial.best();
    table.add({printable(c.scene), std::to_string(c.triangles), to_string(c.mode),
               to_string(c.kind), std::to_string(c.rays), three_digits(c.trial.ms),
               three_digits(best.ms), three_digits(best.loss) + (c.loses() ? "*" : ""), best.name,
               short_plan(c.trial.plan)});
  }
  text += table.text();
  text += fmt::format(
      "{}: more than {:.0f} % slower than the best choice in {}; geometric mean {:.3f}\n",
      count_text(report.cases.size(), "case", "cases"), 100 * (kMostPlanLoss - 1), report.losing(),
      mean_loss(report));
  for (const std::string& note : report.notes) text += printable(note) + "\n";
  return text;
}

std::string plan_json(const PlanReport& report) {
  Json all = {{"command", report.command.words},
              {"threads", report.threads},
              {"runs", report.command.runs},
              {"cases", Json::array()},
              {"geomean", mean_loss(report)},
              {"losing", report.losing()},
              {"notes", report.notes}};
  for (const PlanCase& c : report.cases) {
    Json ways = Json::array();
    for (const PlanWay& way : c.trial.ways)
      ways.push_back({{"name", way.name}, {"ms", way.ms}, {"loss", way.loss}});
    all["cases"].push_back({{"scene", c.scene},
                            {"triangles", c.triangles},
                            {"kind", to_string(c.kind)},
                            {"mode", to_string(c.mode)},
                            {"rays", c.rays},
                            {"plan", short_plan(c.trial.plan)},
                            {"ms", c.trial.ms},
                            {"loss", c.trial.best().loss},
                            {"best", c.trial.best().name},
                            {"ways", std::move(ways)}});
  }
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace raysheaf::app
