// The measured frames as text and as JSON.
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "apps/support/table.h"
#include "lab/commands/scale/report.h"

namespace raysheaf::app {
namespace {

struct Part {
  double ScaleCost::*of;
  const char* name;
};
constexpr std::array<Part, 5> kParts{{{&ScaleCost::decode_s, "decoding"},
                                      {&ScaleCost::cull_s, "culling"},
                                      {&ScaleCost::trace_s, "tracing"},
                                      {&ScaleCost::shading_s, "shading"},
                                      {&ScaleCost::rest_s, "rest"}}};

std::string frames_table(const ScaleReport& report) {
  std::vector<std::string> heading{"triangles",   "pixels",  "rays",
                                   "blocks read", "MB read", "threads"};
  for (const Part& part : kParts) heading.push_back(std::string(part.name) + " ms");
  heading.emplace_back("frame ms");
  Table table(heading);
  const auto add = [&](const ScaleSample& s, std::uint32_t threads) {
    std::vector<std::string> row{short_number(s.triangles),
                                 short_number(s.pixels),
                                 short_number(s.rays),
                                 fmt::format("{} of {}", s.read_blocks, s.blocks),
                                 three_digits(1e-6 * s.cost.bytes),
                                 std::to_string(threads)};
    for (const Part& part : kParts) row.push_back(three_digits(1e3 * s.cost.*part.of));
    row.push_back(three_digits(1e3 * s.seconds));
    table.add(std::move(row));
  };
  for (const ScaleSample& sample : report.samples) add(sample, 1);
  add(report.together, report.threads);
  add(report.check, report.threads);
  return table.text();
}

std::string processes_text(const ScaleReport& report) {
  if (report.rank_runs.empty())
    return "runs of several processes were left out: " + report.no_rank_runs + "\n";
  Table table({"processes", "threads each", "frame ms", "MB read by all"});
  for (const RankRun& run : report.rank_runs)
    table.add({std::to_string(run.ranks), std::to_string(run.threads),
               three_digits(1e3 * run.seconds), three_digits(1e-6 * run.bytes)});
  return "the last frame by processes that share its triangles:\n" + table.text();
}

}  // namespace

std::string scale_text(const ScaleReport& report) {
  return fmt::format(
      "frames; parts are times of one core, the last column is wall time:\n{}\n{}\na triangle "
      "takes "
      "{:.1f} bytes of geometry and {:.1f} of shading in the file; a quarter of the image reads "
      "0.25^{:.2f} of the bytes that the whole image reads\n",
      frames_table(report), processes_text(report), report.geometry_bytes, report.shading_bytes,
      report.sharing);
}

std::string scale_json(const ScaleReport& report) {
  using nlohmann::json;
  const auto of = [](const ScaleSample& s) {
    json j = {{"triangles", s.triangles}, {"pixels", s.pixels},    {"rays", s.rays},
              {"blocks", s.blocks},       {"read", s.read_blocks}, {"batches", s.batches},
              {"seconds", s.seconds},     {"bytes", s.cost.bytes}};
    for (const Part& part : kParts) j[part.name] = s.cost.*part.of;
    return j;
  };
  json samples = json::array(), runs = json::array();
  for (const ScaleSample& sample : report.samples) samples.push_back(of(sample));
  for (const RankRun& run : report.rank_runs)
    runs.push_back({{"ranks", run.ranks},
                    {"threads", run.threads},
                    {"seconds", run.seconds},
                    {"bytes", run.bytes}});
  return json{{"command", report.asked.words},
              {"threads", report.threads},
              {"sharing", report.sharing},
              {"geometry_bytes", report.geometry_bytes},
              {"shading_bytes", report.shading_bytes},
              {"samples", samples},
              {"together", of(report.together)},
              {"check", of(report.check)},
              {"processes", runs},
              {"no_processes", report.no_rank_runs}}
             .dump(2) +
         "\n";
}

}  // namespace raysheaf::app
