// The figures of a bench as tables for a terminal.
#include <fmt/format.h>

#include <cctype>

#include "apps/support/table.h"
#include "lab/commands/paper/combinations.h"
#include "lab/commands/paper/paper.h"

namespace raysheaf::app {
namespace {

std::string whole(std::uint64_t count) {
  return std::to_string(count);
}

std::string published(const PublishedCount& count) {
  if (!count.value) return "-";
  return (count.rounded ? "~" : "") + whole(*count.value);
}

/// Three decimals, or "-" for 0, which stands for an unknown figure.
std::string shown_ratio(double ratio) {
  return ratio > 0 ? fmt::format("{:.3f}", ratio) : "-";
}

std::string shown_percent(double fraction) {
  return fmt::format("{:.3f}", fraction * 100);
}

/// "OFFICE", as the paper writes its own, or "builtin:office".
std::string shown_scene(const std::string& scene, bool builtin) {
  if (builtin) return "builtin:" + scene;
  std::string name = scene;
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

/// "shadow", "reflection 1", "reflection 1 + 2".
std::string shown_rays(const BatchStatistics& counts) {
  std::string kind = to_string(counts.kind);
  if (counts.kind == RayKind::kShadow) return kind;
  return kind + (counts.bounce == 0 ? " 1 + 2" : " " + std::to_string(counts.bounce));
}

std::string totals_text(const PaperReport& report) {
  Table table(
      {"scene", "method", "tests", "brute force", "%", "paper: tests", "paper: %", "ours / paper"});
  for (const SceneTotal& t : scene_totals(report.tables)) {
    const bool known = t.published_total != 0;
    table.add({shown_scene(t.scene, report.builtin), to_string(t.method), whole(t.total),
               whole(t.brute_force), shown_percent(t.relative()),
               known ? whole(t.published_total) : "-",
               known ? shown_percent(t.published_relative()) : "-",
               shown_ratio(ratio(t.total, {t.published_total, false}))});
  }
  return "Totals\n" + table.text();
}

void add_levels(const Measured& m, Table* table) {
  const auto add = [&](const std::string& level, std::uint64_t tests, const std::string& hits,
                       const PublishedCount& paper_tests, const PublishedCount& paper_hits,
                       double hits_ratio) {
    table->add({shown_scene(m.scene, m.builtin), shown_rays(m.counts), to_string(m.method), level,
                whole(tests), hits, published(paper_tests), shown_ratio(ratio(tests, paper_tests)),
                published(paper_hits), shown_ratio(hits_ratio)});
  };
  for (const LevelStatistics& level : m.counts.levels) {
    const PublishedLevel* p = published_level(m, level.level);
    const PublishedLevel known = p != nullptr ? *p : PublishedLevel{};
    add(whole(level.level), level.tests, whole(level.hits), known.tests, known.hits,
        ratio(level.hits, known.hits));
  }
  if (m.counts.bound_tests + m.counts.ray_bound_tests > 0) {
    add("bundles", m.counts.bound_tests, "-", {}, {}, 0);
    add("rays", m.counts.ray_bound_tests, "-", {}, {}, 0);
  }
  add("final", m.counts.final_tests, "-", {}, {}, 0);
  PublishedCount total;
  if (m.published != nullptr) total.value = m.published->total;
  add("total", m.counts.total_tests(), "-", total, {}, 0);
}

std::string levels_text(const PaperReport& report) {
  Table table({"scene", "rays", "method", "level", "tests", "hits", "paper: tests", "ours / paper",
               "paper: hits", "ours / paper"});
  for (const std::string& scene : report.scenes) {
    for (const Measured& m : report.batches)
      if (m.scene == scene) add_levels(m, &table);
    for (const Measured& m : report.tables)
      if (m.scene == scene && m.counts.bounce == 0) add_levels(m, &table);
  }
  return "\nLevels, from the top down; final tests are of rays with triangles\n" + table.text();
}

std::string batches_text(const PaperReport& report) {
  Table table({"scene", "rays", "number", "triangles", "method", "rays that hit", "raygen ms",
               "order", "hierarchy", "traverse", "intersect"});
  for (const Measured& m : report.batches) {
    std::vector<std::string> cells{shown_scene(m.scene, m.builtin),
                                   shown_rays(m.counts),
                                   whole(m.counts.rays),
                                   whole(m.counts.triangles),
                                   to_string(m.method),
                                   m.timed ? whole(m.counts.hits) : "-"};
    const StageTimes& t = m.counts.times_ms;
    for (const double ms : {t.raygen, t.order, t.hierarchy, t.traverse, t.intersect})
      cells.push_back(m.timed ? fmt::format("{:.2f}", ms) : "-");
    table.add(std::move(cells));
  }
  return "\nRays and times\n" + table.text();
}

/// Total tests of every combination in every table.
std::string combinations_text(const PaperReport& report) {
  if (report.combinations.empty()) return "";
  std::vector<std::string> heading{"method", "combination"};
  for (const Measured& m : report.combinations.front().tables)
    heading.push_back(shown_scene(m.scene, m.builtin) + " " + shown_rays(m.counts));
  heading.emplace_back("deviation");
  Table table(heading);
  for (const Combination& c : report.combinations) {
    std::vector<std::string> cells{to_string(c.method), name_of(c.quirks)};
    for (const Measured& m : c.tables) cells.push_back(whole(m.counts.total_tests()));
    cells.push_back(shown_ratio(c.deviation));
    table.add(std::move(cells));
  }
  return "\nTests of the published program, and their mean deviation |ln| from the paper's\n" +
         table.text();
}

}  // namespace

std::string paper_text(const PaperReport& report) {
  return fmt::format("{} scenes, {}x{} pixels, two levels of branching 8\n\n",
                     report.builtin ? "the built-in" : "the paper's", report.width, report.height) +
         totals_text(report) + levels_text(report) + batches_text(report) +
         combinations_text(report);
}

}  // namespace raysheaf::app
