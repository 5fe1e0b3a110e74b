#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/support/table.h"
#include "report/fields.h"

namespace raysheaf::app {
namespace {

constexpr double kLabels = 290, kPlotWidth = 340, kRow = 20, kHead = 26, kGap = 10;

/// A line of a plot: the tests of one kind.
struct Row {
  std::string method, what;
  std::uint64_t tests = 0, hits = 0;
  bool has_hits = false, is_total = false;
};

/// The tests of one batch, or of several.
struct Sum {
  std::vector<LevelStatistics> levels;  ///< from the top down
  std::uint64_t bound_tests = 0, ray_bound_tests = 0, final_tests = 0, mesh_sphere_tests = 0;
  std::uint64_t total = 0, brute_force = 0, rays = 0, hits = 0;

  void add(const BatchStatistics& batch) {
    for (const LevelStatistics& level : batch.levels) {
      const auto same = std::find_if(levels.begin(), levels.end(), [&](const LevelStatistics& l) {
        return l.level == level.level;
      });
      if (same == levels.end()) {
        levels.push_back(level);
        continue;
      }
      same->tests += level.tests;
      same->hits += level.hits;
    }
    std::sort(levels.begin(), levels.end(),
              [](const auto& a, const auto& b) { return a.level > b.level; });
    bound_tests += batch.bound_tests;
    ray_bound_tests += batch.ray_bound_tests;
    final_tests += batch.final_tests;
    mesh_sphere_tests += batch.mesh_sphere_tests;
    total += batch.total_tests();
    brute_force += batch.brute_force_tests();
    rays += batch.rays;
    hits += batch.hits;
  }
};

std::string level_name(Method method, const LevelStatistics& level, std::uint32_t branching) {
  if (method == Method::kGl10)
    return level.level == 1 ? "packets with triangles"
                            : fmt::format("packets with boxes, level {}", level.level);
  const double rays = std::pow(branching, level.level);
  return fmt::format("level {}: bundles of {:.0f} rays", level.level, rays);
}

std::vector<Row> rows_of(Method method, const Sum& sum, std::uint32_t branching) {
  const std::string name = to_string(method);
  std::vector<Row> rows;
  rows.push_back({name, "all tests", sum.total, 0, false, true});
  for (const LevelStatistics& level : sum.levels)
    rows.push_back(
        {name, level_name(method, level, branching), level.tests, level.hits, true, false});
  const auto add = [&](const char* what, std::uint64_t tests) {
    if (tests > 0) rows.push_back({name, what, tests, 0, false, false});
  };
  add("bundles with boxes", sum.bound_tests);
  add("rays with boxes", sum.ray_bound_tests);
  add("rays with triangles", sum.final_tests);
  return rows;
}

/// The logarithmic axis that contains all values.
struct Axis {
  int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();

  explicit Axis(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      if (row.tests == 0) continue;
      const double exponent = std::log10(static_cast<double>(row.tests));
      low = std::min(low, static_cast<int>(std::floor(exponent)));
      high = std::max(high, static_cast<int>(std::ceil(exponent)));
    }
    if (low > high) low = high = 0;
    if (low == high) ++high;
  }
  [[nodiscard]] double x(double tests) const {
    return kLabels + kPlotWidth * (std::log10(tests) - low) / (high - low);
  }
};

std::string power(int exponent) {
  static constexpr const char* kWords[] = {"1",    "10",    "100", "1 k",  "10 k",  "100 k", "1 M",
                                           "10 M", "100 M", "1 G", "10 G", "100 G", "1 T"};
  if (exponent < static_cast<int>(std::size(kWords))) return kWords[exponent];
  return fmt::format("1e{}", exponent);
}

Fields ticks_of(const Axis& axis) {
  Fields ticks = list_of_fields();
  for (int e = axis.low; e <= axis.high; ++e) {
    Fields tick;
    tick.set("x", coordinate(axis.x(std::pow(10.0, e))));
    tick.set("label", power(e));
    ticks.push_back(tick);
  }
  return ticks;
}

std::string percent_of(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  return three_digits(100.0 * static_cast<double>(part) / static_cast<double>(whole)) + " %";
}

/// One plot and its table; `title` names its subject.
Fields plot(const std::string& title, const std::vector<Row>& rows, std::uint64_t brute_force) {
  const Axis axis(rows);
  Fields marks = list_of_fields(), lines = list_of_fields();
  double y = kHead;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (row.is_total && i > 0) y += kGap;
    Fields mark;
    mark.set("y", coordinate(y + kRow / 2));
    mark.set("label", row.is_total ? row.method + ": all tests" : row.what);
    mark.set("kind", row.is_total ? "total" : "part");
    mark.set("x", coordinate(row.tests > 0 ? axis.x(static_cast<double>(row.tests)) : kLabels));
    mark.set("value", shown_count(row.tests));
    marks.push_back(mark);
    Fields line;
    line.set("method", row.method);
    line.set("what", row.what);
    line.set("tests", shown_count(row.tests));
    line.set("hits", row.has_hits ? shown_count(row.hits) : "-");
    line.set("part", row.has_hits ? percent_of(row.hits, row.tests) : "-");
    line.set("relative", percent_of(row.tests, brute_force));
    line.set("kind", row.is_total ? "total" : "part");
    lines.push_back(line);
    y += kRow;
  }
  Fields fields;
  fields.set("title", title);
  fields.set("height", coordinate(y + 8));
  fields.set("bottom", coordinate(y + 2));
  fields.set("start", coordinate(kLabels));
  fields.set("label_end", coordinate(kLabels - 10));
  fields.set("ticks", ticks_of(axis));
  fields.set("marks", marks);
  fields.set("lines", lines);
  return fields;
}

/// Sums over the batches for which `takes` returns true.
template <class Takes>
Fields plot_of(const std::string& title, const Report& report, const Takes& takes) {
  std::vector<Row> rows;
  Sum last;
  for (const MethodReport& method : report.methods) {
    Sum sum;
    for (const BatchStatistics& batch : method.counted.batches)
      if (takes(batch)) sum.add(batch);
    const std::vector<Row> own = rows_of(method.method, sum, report.branching);
    rows.insert(rows.end(), own.begin(), own.end());
    last = sum;
  }
  Fields fields = plot(title, rows, last.brute_force);
  fields.set("rays", shown_count(last.rays));
  fields.set("hit_rays", shown_count(last.hits));
  return fields;
}

/// The choices for a batch, by the methods that make choices.
void set_plan(const Report& report, const BatchStatistics& wanted, Fields* fields) {
  Fields plan = list_of_fields();
  for (const MethodReport& method : report.methods)
    for (const BatchStatistics& batch : method.counted.batches)
      if (batch.kind == wanted.kind && batch.bounce == wanted.bounce)
        for (const std::string& sentence : batch.plan) plan.push_back(Fields("sentence", sentence));
  fields->set("planned", !plan.is_empty_list());
  fields->set("plan", plan);
}

}  // namespace

std::string coordinate(double value) {
  return fmt::format("{:.1f}", value);
}

Fields test_plots(const Report& report) {
  Fields fields;
  fields.set("whole",
             plot_of("all rays of the image", report, [](const BatchStatistics&) { return true; }));
  Fields batches = list_of_fields();
  for (const BatchStatistics& wanted : report.picture.statistics.batches) {
    const std::string title =
        wanted.bounce == 0
            ? "primary rays"
            : fmt::format("{} rays, bounce {}", to_string(wanted.kind), wanted.bounce);
    Fields one = plot_of(title, report, [&](const BatchStatistics& batch) {
      return batch.kind == wanted.kind && batch.bounce == wanted.bounce;
    });
    set_plan(report, wanted, &one);
    batches.push_back(one);
  }
  fields.set("batches", batches);
  return fields;
}

}  // namespace raysheaf::app
