#include "paper/sheets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "table.h"

namespace raysheaf::app {
namespace {

std::string whole(std::uint64_t count) {
  return fmt::format("{}", count);
}

std::string published(const PublishedCount& count) {
  if (!count.value) return "-";
  return (count.rounded ? "~" : "") + whole(*count.value);
}

/// Eight times the hits of the leaves.
PublishedCount published_final(const Measured& m) {
  const PublishedLevel* leaves = published_level(m, 1);
  if (leaves == nullptr || !leaves->hits.value) return {};
  return {*leaves->hits.value * 8, leaves->hits.rounded};
}

void add_levels(const Measured& m, Sheet* sheet) {
  const std::vector<std::string> who{shown_scene(m.scene, m.builtin), shown_rays(m.counts),
                                     to_string(m.method)};
  const auto add = [&](std::vector<std::string> cells) {
    cells.insert(cells.begin(), who.begin(), who.end());
    sheet->rows.push_back(std::move(cells));
  };
  for (const LevelStatistics& level : m.counts.levels) {
    const PublishedLevel* p = published_level(m, level.level);
    const PublishedCount tests = p != nullptr ? p->tests : PublishedCount{};
    const PublishedCount hits = p != nullptr ? p->hits : PublishedCount{};
    add({whole(level.level), whole(level.tests), whole(level.hits), whole(level.misses()),
         published(tests), shown_ratio(ratio(level.tests, tests)), published(hits),
         shown_ratio(ratio(level.hits, hits))});
  }
  const PublishedCount finals = published_final(m);
  const bool by_bounds = m.counts.bound_tests + m.counts.ray_bound_tests > 0;
  if (by_bounds) {
    add({"bundles", whole(m.counts.bound_tests), "-", "-", "-", "-", "-", "-"});
    add({"rays", whole(m.counts.ray_bound_tests), "-", "-", "-", "-", "-", "-"});
  }
  if (by_bounds || !m.counts.levels.empty())
    add({"final", whole(m.counts.final_tests), "-", "-", published(finals),
         shown_ratio(ratio(m.counts.final_tests, finals)), "-", "-"});
  const std::uint64_t total = m.published != nullptr ? m.published->total : 0;
  add({"total", whole(m.counts.total_tests()), "-", "-", total != 0 ? whole(total) : "-",
       shown_ratio(total_ratio(m)), "-", "-"});
}

Sheet totals_sheet(const PaperReport& report) {
  Sheet sheet{
      "Totals",
      "Tests of all kinds of rays, and their percentage of the tests of brute force.",
      {"scene", "method", "tests", "brute force", "%", "paper: tests", "paper: %", "ours / paper"},
      {}};
  for (const SceneTotal& t : scene_totals(report.tables)) {
    const bool known = t.published_total != 0;
    sheet.rows.push_back({shown_scene(t.scene, t.builtin), to_string(t.method), whole(t.total),
                          whole(t.brute_force), shown_percent(t.relative()),
                          known ? whole(t.published_total) : "-",
                          known ? shown_percent(t.published_relative()) : "-",
                          shown_ratio(ratio(t.total, {t.published_total, false}))});
  }
  return sheet;
}

std::string words_on_dual(const PaperReport& report) {
  const auto& all = report.methods;
  if (std::find(all.begin(), all.end(), Method::kDual) == all.end()) return "";
  return " `dual` has no levels: its lines are tests of bundles with boxes or triangles, of rays "
         "with boxes, and of rays "
         "with triangles.";
}

Sheet levels_sheet(const PaperReport& report) {
  Sheet sheet{
      "Levels",
      "From the top down; final tests are ray-triangle tests. ~ marks counts that the paper gives "
      "to three or four digits." +
          words_on_dual(report),
      {"scene", "rays", "method", "level", "tests", "hits", "misses", "paper: tests",
       "ours / paper", "paper: hits", "ours / paper"},
      {}};
  for (const std::string& scene : report.scenes) {
    for (const Measured& m : report.batches)
      if (m.scene == scene) add_levels(m, &sheet);
    for (const Measured& m : report.tables)
      if (m.scene == scene && m.counts.bounce == 0) add_levels(m, &sheet);
  }
  return sheet;
}

Sheet rays_sheet(const PaperReport& report) {
  Sheet sheet{"Rays",
              "No total includes the tests of ray nodes with mesh spheres.",
              {"scene", "rays", "number", "triangles", "method", "chunks sorted",
               "mesh sphere tests", "rays that hit"},
              {}};
  for (const Measured& m : report.batches) {
    const BatchStatistics& c = m.counts;
    sheet.rows.push_back({shown_scene(m.scene, m.builtin), shown_rays(c), whole(c.rays),
                          whole(c.triangles), to_string(m.method), whole(c.chunks),
                          whole(c.mesh_sphere_tests), m.timed ? whole(c.hits) : "-"});
  }
  return sheet;
}

std::string ms(std::optional<double> time) {
  return time ? fmt::format("{:.2f}", *time) : "-";
}

Sheet times_sheet(const PaperReport& report) {
  Sheet sheet{"Times",
              "Milliseconds a batch. Lines marked \"authors\", if there are any, are from the "
              "authors' log and were measured on a GTX TITAN; their "
              "order is compression, sort and decompression.",
              {"scene", "rays", "method", "raygen", "order", "hierarchy", "traverse", "intersect"},
              {}};
  for (const Measured& m : report.batches) {
    if (!m.timed) continue;
    const StageTimes& t = m.counts.times_ms;
    sheet.rows.push_back({shown_scene(m.scene, m.builtin), shown_rays(m.counts),
                          to_string(m.method), ms(t.raygen), ms(t.order), ms(t.hierarchy),
                          ms(t.traverse), ms(t.intersect)});
    if (m.published == nullptr || !m.published->times_ms.hierarchy) continue;
    const PublishedTimes& p = m.published->times_ms;
    sheet.rows.push_back({shown_scene(m.scene, m.builtin), shown_rays(m.counts),
                          std::string(to_string(m.method)) + ", authors", ms(p.raygen), ms(p.order),
                          ms(p.hierarchy), ms(p.traverse), ms(p.intersect)});
  }
  return sheet;
}

bool is_text_column(const Sheet& sheet, std::size_t column) {
  return std::any_of(sheet.rows.begin(), sheet.rows.end(), [&](const auto& row) {
    return row[column].find_first_not_of("0123456789.~- ") != std::string::npos;
  });
}

}  // namespace

std::string shown_scene(const std::string& scene, bool builtin) {
  if (builtin) return "builtin:" + scene;
  std::string name = scene;
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

std::string shown_rays(const BatchStatistics& counts) {
  std::string kind = to_string(counts.kind);
  if (counts.kind == RayKind::kShadow) return kind;
  return kind + (counts.bounce == 0 ? " 1 + 2" : " " + std::to_string(counts.bounce));
}

std::string shown_count(std::uint64_t count) {
  return grouped(whole(count));
}

std::string shown_ratio(double ratio) {
  return ratio > 0 ? fmt::format("{:.3f}", ratio) : "-";
}

std::string shown_percent(double fraction) {
  return fmt::format("{:.3f}", fraction * 100);
}

bool is_far(double ratio) {
  return ratio > 0 && std::fabs(ratio - 1) > 0.1;
}

double SceneTotal::relative() const {
  return brute_force != 0 ? static_cast<double>(total) / static_cast<double>(brute_force) : 0;
}

double SceneTotal::published_relative() const {
  return published_brute_force != 0
             ? static_cast<double>(published_total) / static_cast<double>(published_brute_force)
             : 0;
}

std::vector<SceneTotal> scene_totals(const std::vector<Measured>& tables) {
  std::vector<SceneTotal> all;
  std::vector<bool> known;
  for (const Measured& m : tables) {
    auto at = std::find_if(all.begin(), all.end(), [&](const SceneTotal& t) {
      return t.scene == m.scene && t.method == m.method;
    });
    if (at == all.end()) {
      at = all.insert(all.end(), SceneTotal{m.scene, m.builtin, m.method, 0, 0, 0, 0});
      known.push_back(true);
    }
    const auto place = static_cast<std::size_t>(at - all.begin());
    at->total += m.counts.total_tests();
    at->brute_force += m.counts.brute_force_tests();
    known[place] = known[place] && m.published != nullptr;
    if (m.published != nullptr) {
      at->published_total += m.published->total;
      at->published_brute_force += m.published->brute_force_tests();
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!known[i]) all[i].published_total = all[i].published_brute_force = 0;
  return all;
}

std::vector<Sheet> paper_sheets(const PaperReport& report, bool times) {
  std::vector<Sheet> all{totals_sheet(report), levels_sheet(report), rays_sheet(report)};
  if (times) all.push_back(times_sheet(report));
  return all;
}

std::string sheet_text(const Sheet& sheet) {
  Table table(sheet.heading);
  for (const auto& row : sheet.rows) table.add(row);
  return sheet.title + "\n" + table.text();
}

std::string sheet_markdown(const Sheet& sheet) {
  std::string text = "## " + sheet.title + "\n\n";
  if (!sheet.note.empty()) text += sheet.note + "\n\n";
  std::string rule = "|";
  text += "|";
  for (std::size_t c = 0; c < sheet.heading.size(); ++c) {
    text += " " + sheet.heading[c] + " |";
    rule += is_text_column(sheet, c) ? "---|" : "---:|";
  }
  text += "\n" + rule + "\n";
  for (const auto& row : sheet.rows) {
    text += "|";
    for (const std::string& cell : row) text += " " + grouped(cell) + " |";
    text += "\n";
  }
  return text;
}

}  // namespace raysheaf::app
