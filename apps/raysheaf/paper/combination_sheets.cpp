// Tables about the switches of the published program.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "paper/combinations.h"
#include "paper/sheets.h"

namespace raysheaf::app {
namespace {

constexpr const char* kDefaults =
    "*signed* without additions means the defaults: equation 9 with a signed distance along the "
    "axis, the key "
    "as coded with the azimuth atan2(x, x), rows from below, minimum spheres of triangles, mesh "
    "spheres that rotate with their meshes, and the last node counted as if it were full.";

constexpr std::array kMethods{Method::kRah, Method::kCrsh};

const Combination* defaults_of(const std::vector<Combination>& list, Method method) {
  for (const Combination& c : list)
    if (c.method == method) return &c;
  return nullptr;
}

double over(std::uint64_t ours, std::uint64_t theirs) {
  return theirs != 0 ? static_cast<double>(ours) / static_cast<double>(theirs) : 0;
}

/// The library's total divided by the published one, or by the total of the defaults if none was
/// published.
double compared(const Combination& c, std::size_t table, const Combination& defaults) {
  const Measured& m = c.tables[table];
  if (m.published != nullptr) return total_ratio(m);
  return over(m.counts.total_tests(), defaults.tables[table].counts.total_tests());
}

Sheet ratios_sheet(const PaperReport& report, Method method) {
  const Combination& defaults = *defaults_of(report.combinations, method);
  Sheet sheet;
  sheet.title = std::string("Switches of the published ") + to_string(method);
  sheet.note =
      report.builtin
          ? "Total tests divided by those of the first row, because nothing was published for "
            "these scenes. "
          : "Total tests divided by the published ones; the last column is the mean of |ln| of "
            "this ratio and of the ratios of each level's hits, over all tables. ";
  sheet.note += kDefaults;
  sheet.heading = {"combination"};
  for (const Measured& m : defaults.tables)
    sheet.heading.push_back(shown_scene(m.scene, m.builtin) + " " + shown_rays(m.counts));
  sheet.heading.emplace_back("deviation");
  for (const Combination& c : report.combinations) {
    if (c.method != method) continue;
    sheet.rows.push_back({name_of(c.quirks)});
    for (std::size_t i = 0; i < c.tables.size(); ++i)
      sheet.rows.back().push_back(shown_ratio(compared(c, i, defaults)));
    sheet.rows.back().push_back(shown_ratio(c.deviation));
  }
  return sheet;
}

/// The combination that is nearest to one table; the first of equals.
const Combination* nearest_of_table(const PaperReport& report, Method method, std::size_t table) {
  const Combination* best = nullptr;
  for (const Combination& c : report.combinations) {
    if (c.method != method || c.tables[table].published == nullptr) continue;
    if (best == nullptr || deviation(c.tables[table]) < deviation(best->tables[table])) best = &c;
  }
  return best;
}

Sheet nearest_sheet(const PaperReport& report) {
  Sheet sheet{"Nearest combinations",
              "The nearest by the total and by the hits of each level that the paper gives.",
              {"table", "method", "nearest combination", "total, ours / paper", "deviation"},
              {}};
  for (const Method method : kMethods) {
    const Combination& defaults = *defaults_of(report.combinations, method);
    for (std::size_t i = 0; i < defaults.tables.size(); ++i) {
      const Combination* best = nearest_of_table(report, method, i);
      if (best == nullptr) continue;
      const Measured& m = best->tables[i];
      sheet.rows.push_back({shown_scene(m.scene, m.builtin) + " " + shown_rays(m.counts),
                            to_string(method), name_of(best->quirks), shown_ratio(total_ratio(m)),
                            shown_ratio(deviation(m))});
    }
    const Combination* best = nearest(report, method);
    sheet.rows.push_back(
        {"all", to_string(method), name_of(best->quirks), "-", shown_ratio(best->deviation)});
  }
  return sheet;
}

void add_nearest_levels(const Measured& m, Sheet* sheet) {
  const auto add = [&](const std::string& level, std::uint64_t tests, double tests_ratio,
                       std::string hits, double hits_ratio) {
    sheet->rows.push_back({shown_scene(m.scene, m.builtin), shown_rays(m.counts),
                           to_string(m.method), level, std::to_string(tests),
                           shown_ratio(tests_ratio), std::move(hits), shown_ratio(hits_ratio),
                           is_far(tests_ratio) || is_far(hits_ratio) ? "yes" : "no"});
  };
  for (const LevelStatistics& level : m.counts.levels) {
    const PublishedLevel* p = published_level(m, level.level);
    add(std::to_string(level.level), level.tests, p != nullptr ? ratio(level.tests, p->tests) : 0,
        std::to_string(level.hits), p != nullptr ? ratio(level.hits, p->hits) : 0);
  }
  add("final", m.counts.final_tests, 0, "-", 0);
  add("total", m.counts.total_tests(), total_ratio(m), "-", 0);
}

Sheet nearest_levels_sheet(const PaperReport& report) {
  Sheet sheet{"Levels of the nearest combinations",
              "For each method, the combination that is nearest to all tables.",
              {"scene", "rays", "method", "level", "tests", "ours / paper", "hits", "ours / paper",
               "differs by more than 10 %"},
              {}};
  for (const Method method : kMethods)
    for (const Measured& m : nearest(report, method)->tables) add_nearest_levels(m, &sheet);
  return sheet;
}

struct Range {
  double low = 1e30, high = 0;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/// The effect of leaving out the first few rays on one table.
std::vector<std::string> phase_row(const PaperReport& report, Method method, std::size_t table) {
  const Combination& defaults = *defaults_of(report.phases, method);
  const Measured& first = defaults.tables[table];
  Range total;
  std::vector<Range> hits(first.counts.levels.size());
  for (const Combination& c : report.phases) {
    if (c.method != method) continue;
    const Measured& m = c.tables[table];
    total.add(compared(c, table, defaults));
    for (std::size_t l = 0; l < hits.size(); ++l) {
      const PublishedLevel* p = published_level(m, m.counts.levels[l].level);
      hits[l].add(p != nullptr && p->hits.value
                      ? ratio(m.counts.levels[l].hits, p->hits)
                      : over(m.counts.levels[l].hits, first.counts.levels[l].hits));
    }
  }
  std::vector<std::string> row{shown_scene(first.scene, first.builtin), shown_rays(first.counts),
                               to_string(method), shown_ratio(total.low), shown_ratio(total.high)};
  for (const Range& r : hits) {
    row.push_back(shown_ratio(r.low));
    row.push_back(shown_ratio(r.high));
  }
  return row;
}

Sheet phase_sheet(const PaperReport& report) {
  Sheet sheet{"The effect of a few rays",
              "The defaults without the first 0, 1, 2, 4, 8, 16 and 32 rays, so that every node "
              "holds other rays. The table has the least and the greatest count divided by the "
              "published one, or by that "
              "with all rays if none was published.",
              {"scene", "rays", "method", "total from", "to", "level 2 hits from", "to",
               "level 1 hits from", "to"},
              {}};
  for (const Method method : kMethods)
    for (std::size_t i = 0; i < defaults_of(report.phases, method)->tables.size(); ++i)
      sheet.rows.push_back(phase_row(report, method, i));
  return sheet;
}

Sheet sweep_sheet(const PaperReport& report) {
  Sheet sheet{"Depth and branching",
              "CORNELL's shadow rays with the defaults, compared with the authors' log: the total, "
              "and ours / "
              "paper of the hits of each level.",
              {"method", "levels", "branching", "tests", "paper: tests", "ours / paper",
               "hits, from the top down"},
              {}};
  for (const Measured& m : report.sweep) {
    if (m.published == nullptr) continue;
    std::string hits;
    for (const LevelStatistics& level : m.counts.levels) {
      const PublishedLevel* p = published_level(m, level.level);
      hits += (hits.empty() ? "" : ", ") + shown_ratio(ratio(level.hits, p->hits));
    }
    sheet.rows.push_back({to_string(m.method), std::to_string(m.published->depth),
                          std::to_string(m.published->branching),
                          std::to_string(m.counts.total_tests()),
                          std::to_string(m.published->total), shown_ratio(total_ratio(m)), hits});
  }
  return sheet;
}

}  // namespace

std::vector<Sheet> combination_sheets(const PaperReport& report) {
  if (report.combinations.empty()) return {};
  std::vector<Sheet> all;
  for (const Method method : kMethods) all.push_back(ratios_sheet(report, method));
  const Combination* best = nearest(report, Method::kRah);
  if (best->deviation > 0) {
    all.push_back(nearest_sheet(report));
    all.push_back(nearest_levels_sheet(report));
    all.push_back(sweep_sheet(report));
  }
  all.push_back(phase_sheet(report));
  return all;
}

}  // namespace raysheaf::app
