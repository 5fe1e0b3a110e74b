#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/support/console.h"
#include "apps/support/table.h"
#include "lab/commands/compare/compare.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

Json peer_ms_json(const PeerTimes& ms) {
  return {{"build", ms.build}, {"trace", ms.trace}, {"total", ms.total}};
}

Json hits_json(const HitCheck& hits) {
  return {{"compared", hits.compared},
          {"mismatches", hits.mismatches},
          {"settled", hits.settled},
          {"ours_right", hits.ours_right},
          {"peer_right", hits.peer_right},
          {"other_triangles", hits.other_triangles},
          {"brute_force_compared", hits.sampled},
          {"brute_force_mismatches", hits.sample_mismatches}};
}

Json trials_json(const std::vector<PeerTrial>& trials) {
  Json all = Json::array();
  for (const PeerTrial& trial : trials)
    all.push_back({{"peer", trial.name},
                   {"peer_version", trial.version},
                   {"peer_ms", peer_ms_json(trial.ms)}});
  return all;
}

Json peers_json(const std::vector<PeerResult>& peers) {
  Json all = Json::array();
  for (const PeerResult& peer : peers)
    all.push_back({{"name", "Embree"},
                   {"version", peer.version},
                   {"way", peer.way},
                   {"peer_ms", peer_ms_json(peer.ms)},
                   {"ratio", peer.ratio},
                   {"cpu_ratio", peer.cpu_ratio},
                   {"hits_equal", peer.hits.equal()},
                   {"hits", hits_json(peer.hits)},
                   {"bytes", peer.bytes}});
  return all;
}

Json case_json(const CompareCase& c) {
  const std::optional<double> limit = limit_of(c);
  return {{"scene", c.scene},
          {"size", size_text(c.size)},
          {"triangles", c.triangles},
          {"kind", to_string(c.kind)},
          {"mode", to_string(c.mode)},
          {"rays", c.rays},
          {"threads", c.threads},
          {"ours_ms",
           {{"update", c.ours_ms.update},
            {"order", c.ours_ms.order},
            {"hierarchy", c.ours_ms.hierarchy},
            {"trace", c.ours_ms.trace},
            {"total", c.ours_ms.total}}},
          {"peer", "embree " + c.peer.way},
          {"peer_name", "Embree"},
          {"peer_version", c.peer.version},
          {"peer_ms", peer_ms_json(c.peer.ms)},
          {"ratio", c.peer.ratio},
          {"cpu_ratio", c.peer.cpu_ratio},
          {"worst_frame", c.worst_frame},
          {"limit", limit ? Json(*limit) : Json(nullptr)},
          {"hits_equal", c.peer.hits.equal()},
          {"hits", hits_json(c.peer.hits)},
          {"ours_bytes", c.our_bytes},
          {"peer_bytes", c.peer.bytes},
          {"plan", c.plan},
          {"plan_short", short_plan(c.plan)},
          {"peers", peers_json(c.peers)},
          {"peer_trials", trials_json(c.trials)}};
}

/// {"rebuild": {"shadow": 0.4, ..., "all": 0.6}, ...}
Json means_json(const std::vector<CompareCase>& cases, double PeerResult::*ratio) {
  Json all = Json::object();
  for (const CompareCase& c : cases) {
    const std::string row = row_of(c), kind = to_string(c.kind);
    const auto is_alike = [&](const CompareCase& other) {
      return row_of(other) == row && other.kind == c.kind;
    };
    const auto is_in_row = [&](const CompareCase& other) { return row_of(other) == row; };
    all[row][kind] = mean_ratio(cases, is_alike, ratio);
    all[row]["all"] = mean_ratio(cases, is_in_row, ratio);
  }
  return all;
}

}  // namespace

std::string compare_json(const CompareReport& report) {
  Json all = {{"command", report.command.words},
              {"peer", report.peer},
              {"threads", report.threads},
              {"runs", report.command.runs},
              {"cases", Json::array()},
              {"geomean", means_json(report.cases, &PeerResult::ratio)},
              {"cpu_geomean", means_json(report.cases, &PeerResult::cpu_ratio)},
              {"growth", Json::array()},
              {"notes", report.notes},
              {"peak_bytes", report.peak_bytes}};
  for (const CompareCase& c : report.cases) all["cases"].push_back(case_json(c));
  for (const GrowthCase& g : report.growth) {
    Json point = case_json(g.measured);
    point["along"] = g.along;
    all["growth"].push_back(std::move(point));
  }
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string compare_text(const CompareReport& report) {
  std::string text =
      fmt::format("compared with {}, {} threads, medians of {} rounds; * exceeds its limit\n",
                  report.peer, report.threads, report.command.runs);
  Table table({"scene", "triangles", "mode", "kind", "rays", "ours ms", "peer ms", "ratio",
               "cpu ratio", "worst frame", "limit", "hits", "peer", "plan"});
  const auto add = [&](const CompareCase& c) {
    const std::optional<double> limit = limit_of(c);
    table.add({printable(label_of(c)), std::to_string(c.triangles), to_string(c.mode),
               to_string(c.kind), std::to_string(c.rays), three_digits(c.ours_ms.total),
               three_digits(c.peer.ms.total),
               three_digits(c.peer.ratio) + (misses_limit(c) ? "*" : ""),
               three_digits(c.peer.cpu_ratio), c.worst_frame > 0 ? three_digits(c.worst_frame) : "",
               limit ? fmt::format("{:g}", *limit) : "",
               c.peer.hits.equal() ? "equal" : fmt::format("{} differ", c.peer.hits.mismatches),
               c.peer.version + " " + c.peer.way, short_plan(c.plan)});
  };
  for (const CompareCase& c : report.cases) add(c);
  for (const GrowthCase& g : report.growth) add(g.measured);
  text += table.text();
  for (const std::string& note : report.notes) text += printable(note) + "\n";
  return text;
}

}  // namespace raysheaf::app
