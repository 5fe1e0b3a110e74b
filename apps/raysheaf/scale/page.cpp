// The predictions of a model of streamed frames, as text and as a page.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "scale/report.h"
#include "table.h"

namespace raysheaf::app {
namespace {

using Rows = std::vector<std::vector<std::string>>;

struct Field {
  double ScaleCost::*of;
  const char* name;
  const char* key;  ///< in JSON
};
constexpr std::array<Field, 5> kSeconds{{{&ScaleCost::decode_s, "decoding", "decoding"},
                                         {&ScaleCost::cull_s, "culling", "culling"},
                                         {&ScaleCost::trace_s, "tracing", "tracing"},
                                         {&ScaleCost::shading_s, "shading", "shading"},
                                         {&ScaleCost::rest_s, "the rest", "rest"}}};

std::string seconds(double s) {
  if (s < 1) return fmt::format("{:.3g} ms", 1e3 * s);
  return s < 600 ? fmt::format("{:.3g} s", s) : fmt::format("{:.3g} min", s / 60);
}
std::string amount(double x) {
  if (x >= 1e9) return fmt::format("{:g} G", std::round(x / 1e8) / 10);
  if (x >= 1e6) return fmt::format("{:g} M", std::round(x / 1e5) / 10);
  return fmt::format("{:g} k", std::round(x / 1e2) / 10);
}
std::string bytes(double x) {
  return amount(x) + "B";
}

/// A table of Markdown, or one for a terminal.
std::string table(const Rows& rows, bool markdown) {
  if (!markdown) {
    Table text(rows.front());
    for (std::size_t i = 1; i < rows.size(); ++i) text.add(rows[i]);
    return text.text();
  }
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::string& cell : rows[i]) text += "| " + cell + " ";
    text += "|\n";
    if (i != 0) continue;
    for (std::size_t c = 0; c < rows[i].size(); ++c) text += "|---";
    text += "|\n";
  }
  return text;
}

double serial_of(const ScaleReport& report) {
  return serial_part(report.samples.back().cost.core_s(), report.together.seconds, report.threads);
}

ScaleMachines machines_of(const ScaleReport& report, std::uint32_t ranks) {
  ScaleMachines m;
  m.ranks = ranks;
  m.cores = report.asked.cores;
  m.serial = serial_of(report);
  m.disk_bytes_s = 1e6 * report.asked.disk_mb_s;
  m.network_bytes_s = 1e6 * report.asked.network_mb_s;
  return m;
}

double pixels_of(const ScaleReport& report) {
  return static_cast<double>(report.asked.side) * report.asked.side;
}
double batches_of(const ScaleReport& report) {
  return report.samples.back().batches;
}

std::string measured_table(const ScaleReport& report, bool markdown) {
  Rows rows{{"triangles", "pixels", "rays", "blocks read", "bytes read", "decoding", "culling",
             "tracing", "shading", "the rest", "frame"}};
  const auto add = [&](const ScaleSample& s) {
    std::vector<std::string> row{amount(s.triangles), amount(s.pixels), amount(s.rays),
                                 fmt::format("{} of {}", s.read_blocks, s.blocks),
                                 bytes(s.cost.bytes)};
    for (const Field& field : kSeconds) row.push_back(seconds(s.cost.*field.of));
    row.push_back(seconds(s.seconds));
    rows.push_back(row);
  };
  for (const ScaleSample& sample : report.samples) add(sample);
  return table(rows, markdown);
}

std::string constants_table(const ScaleModel& model, bool markdown) {
  Rows rows{{"resource", "a frame", "a million triangles", "a million pixels"}};
  const auto add = [&](const char* name, double ScaleCost::*field, const auto& shown) {
    const auto k = model.coefficients(field);
    rows.push_back({name, shown(k[0]), shown(1e6 * k[1]), shown(1e6 * k[2])});
  };
  for (const Field& field : kSeconds) add(field.name, field.of, seconds);
  add("bytes read", &ScaleCost::bytes, bytes);
  return table(rows, markdown);
}

/// Processes on this machine, without disk and network.
ScaleMachines processes_here(const ScaleReport& report, std::uint32_t ranks,
                             std::uint32_t threads) {
  ScaleMachines here;
  here.ranks = ranks;
  here.cores = threads;
  here.serial = serial_of(report);
  here.disk_bytes_s = here.network_bytes_s = std::numeric_limits<double>::infinity();
  here.latency_s = 0;
  return here;
}

/// Wall time in seconds that the model predicts for a frame on this machine, from its cache.
double expected_seconds(const ScaleReport& report, const ScaleModel& model,
                        const ScaleSample& sample) {
  return clock_seconds(model.cost(sample.triangles, sample.pixels).core_s(),
                       processes_here(report, 1, report.threads));
}

std::string check_sentence(const ScaleReport& report, const ScaleModel& model) {
  const ScaleSample& s = report.check;
  const double guess = expected_seconds(report, model, s);
  const double guessed_bytes = model.cost(s.triangles, s.pixels).bytes;
  return fmt::format(
      "A frame that was not used for the fit, with {} triangles and {} pixels, on {} threads: {} "
      "predicted, "
      "{} measured (ratio {:.2f}); {} predicted to be read, {} read (ratio {:.2f}).\n",
      amount(s.triangles), amount(s.pixels), report.threads, seconds(guess), seconds(s.seconds),
      guess / s.seconds, bytes(guessed_bytes), bytes(s.cost.bytes), guessed_bytes / s.cost.bytes);
}

/// The times of processes on this machine, whose messages go through its memory.
std::string rank_runs_text(const ScaleReport& report, const ScaleModel& model, bool markdown) {
  if (report.rank_runs.empty())
    return "Runs of several processes were left out: " + report.no_rank_runs + "\n";
  Rows rows{{"processes", "threads each", "predicted", "measured", "predicted / measured",
             "bytes read by all"}};
  for (const RankRun& run : report.rank_runs) {
    const double expected =
        forecast_geometry(model, report.check.triangles, report.check.pixels, report.check.batches,
                          processes_here(report, run.ranks, run.threads))
            .total_s;
    rows.push_back({std::to_string(run.ranks), std::to_string(run.threads), seconds(expected),
                    seconds(run.seconds), fmt::format("{:.2f}", expected / run.seconds),
                    bytes(run.bytes)});
  }
  return table(rows, markdown);
}

std::string serial_sentence(const ScaleReport& report) {
  const ScaleSample &one = report.samples.back(), &all = report.together;
  return fmt::format(
      "The last of these frames takes {} on {} threads and {} on one, so {:.1f} % of its work is "
      "serial (Amdahl 1967).\n",
      seconds(all.seconds), report.threads, seconds(one.cost.core_s()), 100 * serial_of(report));
}

std::string growth_table(const ScaleReport& report, const ScaleModel& model, bool markdown) {
  Rows rows{{"triangles", "file", "read", "disk", "cores", "frame", "bound by"}};
  for (const double triangles : {1e6, 1e7, 1e8, 1e9, 1e10}) {
    const ScaleForecast f = forecast_geometry(model, triangles, pixels_of(report),
                                              batches_of(report), machines_of(report, 1));
    rows.push_back({amount(triangles),
                    bytes(triangles * (report.geometry_bytes + report.shading_bytes)),
                    bytes(model.cost(triangles, pixels_of(report)).bytes), seconds(f.disk_s),
                    seconds(f.compute_s), seconds(f.total_s), f.bound_by});
  }
  return table(rows, markdown);
}

std::vector<std::uint32_t> ranks_up_to(std::uint32_t most) {
  std::vector<std::uint32_t> all;
  for (std::uint32_t r = 1; r < most; r *= 2) all.push_back(r);
  all.push_back(most);
  return all;
}

std::string ranks_table(const ScaleReport& report, const ScaleModel& model, bool markdown) {
  Rows rows{{"machines", "geometry: disk", "cores", "network", "frame", "bound by", "rays: disk",
             "cores", "network", "frame", "bound by"}};
  const double triangles = static_cast<double>(report.asked.triangles);
  for (const std::uint32_t ranks : ranks_up_to(report.asked.machines)) {
    const ScaleMachines m = machines_of(report, ranks);
    const ScaleForecast g =
        forecast_geometry(model, triangles, pixels_of(report), batches_of(report), m);
    const ScaleForecast r = forecast_rays(model, triangles, pixels_of(report), report.sharing, m);
    std::vector<std::string> row{std::to_string(ranks)};
    for (const ScaleForecast& f : {g, r}) {
      for (const double s : {f.disk_s, f.compute_s, f.network_s, f.total_s})
        row.push_back(seconds(s));
      row.emplace_back(f.bound_by);
    }
    rows.push_back(row);
  }
  return table(rows, markdown);
}

/// The disk speed at which reading takes as long as everything else, and the number of machines at
/// which combining hits does.
std::string saturation(const ScaleReport& report, const ScaleModel& model) {
  const double triangles = static_cast<double>(report.asked.triangles);
  const double pixels = pixels_of(report);
  const ScaleMachines one = machines_of(report, 1);
  const ScaleForecast alone = forecast_geometry(model, triangles, pixels, batches_of(report), one);
  const double balance = model.cost(triangles, pixels).bytes / alone.compute_s;
  std::string text = fmt::format(
      "* **Disk and cores** take equally long if the disk of a machine reads {}/s for {} cores; a "
      "slower disk limits the frame.\n",
      bytes(balance), report.asked.cores);
  std::uint32_t ranks = 2;
  ScaleForecast f;
  constexpr std::uint32_t kMost = 1u << 20;
  for (; ranks < kMost; ranks *= 2) {
    f = forecast_geometry(model, triangles, pixels, batches_of(report), machines_of(report, ranks));
    if (f.network_s >= std::max(f.disk_s, f.compute_s)) break;
  }
  if (ranks < kMost)
    text += fmt::format(
        "* **The network**: with {} machines, combining the hits takes longer ({}) than streaming "
        "a "
        "machine's part ({}). More machines do not make the frame faster: share rays or frames "
        "instead.\n",
        ranks, seconds(f.network_s), seconds(std::max(f.disk_s, f.compute_s)));
  const double fixed = model.cost(0, pixels).core_s() / report.asked.cores;
  text += fmt::format(
      "* **Work that is not divided** if geometry is shared: every machine generates, orders and "
      "shades all rays, which takes {} a frame, whatever the number of machines.\n",
      seconds(fixed));
  return text;
}

std::string conditions(const ScaleReport& report) {
  return fmt::format(
      "{0}x{0} pixels, machines of {1} cores, disks of {2}/s and networks of {3}/s each",
      report.asked.side, report.asked.cores, bytes(1e6 * report.asked.disk_mb_s),
      bytes(1e6 * report.asked.network_mb_s));
}

}  // namespace

std::string scale_text(const ScaleReport& report) {
  const ScaleModel model(report.samples);
  return fmt::format(
      "measured on one thread while another reads; times of one core, except the frame's wall "
      "time:\n"
      "{}\n{}\n"
      "fitted:\n{}\n{}\n"
      "the same frame by processes that share its triangles:\n{}\n"
      "one machine; {}:\n{}\n"
      "{} triangles on several machines:\n{}\n{}",
      measured_table(report, false), serial_sentence(report), constants_table(model, false),
      check_sentence(report, model), rank_runs_text(report, model, false), conditions(report),
      growth_table(report, model, false), amount(static_cast<double>(report.asked.triangles)),
      ranks_table(report, model, false), saturation(report, model));
}

std::string scale_page(const ScaleReport& report) {
  const ScaleModel model(report.samples);
  const double triangles = static_cast<double>(report.asked.triangles);
  const auto ranks = report.asked.machines;
  const ScaleForecast one = forecast_geometry(model, triangles, pixels_of(report),
                                              batches_of(report), machines_of(report, 1));
  const ScaleForecast g = forecast_geometry(model, triangles, pixels_of(report), batches_of(report),
                                            machines_of(report, ranks));
  const ScaleForecast r = forecast_rays(model, triangles, pixels_of(report), report.sharing,
                                        machines_of(report, ranks));
  const bool usual = report.asked.triangles == BenchScaleCommand{}.triangles;
  std::string text = fmt::format("# Scale: what {} triangles would take\n\n",
                                 usual ? "a thousand million" : amount(triangles));
  text += fmt::format(
      "`raysheaf bench scale` wrote this page. It renders generated halls that "
      "[stream](../stream.md), fits a linear model of the time and bytes that each resource takes, "
      "checks the model with "
      "a frame that was not used for the fit, and extrapolates. Only the tables under \"Measured\" "
      "and \"Processes\" are measurements.\n\n"
      "**{} triangles, {}**: a frame takes {} on one machine, limited by its {}; {} on {} machines "
      "that share the "
      "triangles, limited by the {}; {} if they share the rays, limited by the {}.\n\n",
      amount(triangles), conditions(report), seconds(one.total_s), one.bound_by, seconds(g.total_s),
      ranks, g.bound_by, seconds(r.total_s), r.bound_by);
  text += fmt::format(
      "## Measured\n\nOne thread traces while another reads; files are in the system's cache. "
      "Times are those of one core, except the frame's, which is wall time.\n\n{}\n{}\n{}\nA "
      "triangle takes {:.1f} bytes of geometry and "
      "{:.1f} of shading in the "
      "file. A quarter of the image reads 0.25^{:.2f} of the bytes that the whole image "
      "reads.\n\n",
      measured_table(report, true), serial_sentence(report), check_sentence(report, model),
      report.geometry_bytes, report.shading_bytes, report.sharing);
  text += "## Fitted\n\n" + constants_table(model, true) +
          "\nDisk and cores work at the same time, so a frame takes the longer of the two, plus "
          "the time of the network.\n\n";
  text +=
      "## Processes\n\nThe frame that was not used for the fit, rendered by processes on one "
      "machine that "
      "share its triangles (`mpirun -n 2 raysheaf render hall.rsb`), and the prediction for "
      "machines whose disk and network take no time.\n\n" +
      rank_runs_text(report, model, true) + "\n";
  text += "## One machine\n\n" + growth_table(report, model, true) + "\n";
  text += fmt::format(
      "## Several machines\n\nThe scene has {} triangles. *Geometry*: each machine streams its own "
      "blocks past "
      "all rays, and the machines combine their hits after each of {:.0f} batches, with {:.0f} "
      "bytes a ray, in a ring. "
      "*Rays*: each machine has a part of the image, and streams the blocks that its rays may "
      "intersect.\n\n{}\n"
      "## Where it saturates\n\n{}\n",
      amount(triangles), batches_of(report), kHitBytes, ranks_table(report, model, true),
      saturation(report, model));
  text +=
      "The model ignores machines of unequal speed, shared disks, and hits that are "
      "sent while blocks still stream.\n";
  return text;
}

std::string scale_json(const ScaleReport& report) {
  using nlohmann::json;
  const ScaleModel model(report.samples);
  const auto of = [](const ScaleSample& s) {
    json j = {{"triangles", s.triangles}, {"pixels", s.pixels},    {"rays", s.rays},
              {"blocks", s.blocks},       {"read", s.read_blocks}, {"batches", s.batches},
              {"seconds", s.seconds},     {"bytes", s.cost.bytes}};
    for (const Field& field : kSeconds) j[field.key] = s.cost.*field.of;
    return j;
  };
  json samples = json::array();
  for (const ScaleSample& sample : report.samples) samples.push_back(of(sample));
  json runs = json::array();
  for (const RankRun& run : report.rank_runs)
    runs.push_back({{"ranks", run.ranks},
                    {"threads", run.threads},
                    {"seconds", run.seconds},
                    {"bytes", run.bytes}});
  const double guess = expected_seconds(report, model, report.check);
  return json{{"threads", report.threads},
              {"sharing", report.sharing},
              {"geometry_bytes", report.geometry_bytes},
              {"shading_bytes", report.shading_bytes},
              {"samples", samples},
              {"together", of(report.together)},
              {"serial", serial_of(report)},
              {"check", of(report.check)},
              {"processes", runs},
              {"check_expected_seconds", guess}}
             .dump(2) +
         "\n";
}

}  // namespace raysheaf::app
