#include <fmt/format.h>

#include <algorithm>

#include "apps/support/table.h"
#include "report/fields.h"

namespace raysheaf::app {
namespace {

constexpr double kLabels = 70, kPlotWidth = 540, kRow = 34, kBar = 22, kHead = 26;
/// A method that is slower than the next one by more than this factor is not drawn to scale,
/// because it would flatten all others.
constexpr double kFarSlower = 6;

struct Stage {
  const char* id;
  const char* name;
  const char* text;
};
constexpr Stage kStages[] = {
    {"raster", "primary rays", "finding the surfaces that the camera sees"},
    {"raygen", "ray generation",
     "making shadow rays, reflections, refractions, and their sort keys"},
    {"order", "order", "sorting the rays, so that neighbouring rays are similar"},
    {"hierarchy", "hierarchy", "computing bounds of bundles, or trees over triangles"},
    {"traverse", "traversal", "testing bounds against triangles and boxes; for dual all tests"},
    {"intersect", "intersection", "testing rays against triangles"},
    {"shade", "shading", "computing light from hits"},
    {"rest", "rest", "flattening the scene, textures, memory"}};

std::vector<double> stage_times(const FrameStatistics& s) {
  StageTimes sum;
  for (const BatchStatistics& batch : s.batches) sum.add(batch.times_ms);
  std::vector<double> all = {s.raster_ms,  sum.raygen,    sum.order, sum.hierarchy,
                             sum.traverse, sum.intersect, s.shade_ms};
  double known = 0;
  for (const double ms : all) known += ms;
  all.push_back(std::max(0.0, s.total_ms - known));
  return all;
}

/// The longest bar that fits the scale.
double scale_end(const Report& report) {
  std::vector<double> totals;
  for (const MethodReport& method : report.methods)
    if (method.ran) totals.push_back(method.times.total_ms);
  std::sort(totals.begin(), totals.end());
  while (totals.size() > 1 && totals.back() > kFarSlower * totals[totals.size() - 2])
    totals.pop_back();
  return totals.empty() ? 1 : totals.back();
}

/// Round steps, of which there are three to six.
double step_of(double end) {
  double step = 1e-3;
  for (int i = 0; end / step > 6; ++i) step *= i % 3 == 1 ? 2.5 : 2;
  return step;
}

Fields segments(const std::vector<double>& times, double end, double y) {
  Fields all = list_of_fields();
  double x = kLabels;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double width = kPlotWidth * times[i] / end;
    Fields segment;
    segment.set("x", coordinate(x));
    segment.set("y", coordinate(y));
    segment.set("width", coordinate(width));
    segment.set("height", coordinate(kBar));
    segment.set("id", kStages[i].id);
    segment.set("title", fmt::format("{}: {} ms", kStages[i].name, shown_ms(times[i])));
    if (width >= 0.05) all.push_back(segment);
    x += width;
  }
  return all;
}

}  // namespace

std::string shown_ms(double ms) {
  return three_digits(ms);
}

Fields time_plot(const Report& report) {
  const double end = scale_end(report);
  Fields rows = list_of_fields(), stages = list_of_fields(), ticks = list_of_fields();
  double y = kHead;
  for (const MethodReport& method : report.methods) {
    const bool fits = method.ran && method.times.total_ms <= end;
    const std::vector<double> times = stage_times(method.times);
    Fields row, cells = list_of_fields();
    row.set("method", to_string(method.method));
    row.set("y", coordinate(y + kBar / 2));
    row.set("fits", fits);
    row.set("far", method.ran && !fits);
    row.set("counted", !method.ran);
    row.set("ran", method.ran);
    row.set("total", shown_ms(method.times.total_ms));
    row.set("end", coordinate(fits ? kLabels + kPlotWidth * method.times.total_ms / end + 8
                                   : kLabels + 8));
    row.set("segments", fits ? segments(times, end, y) : list_of_fields());
    for (const double ms : times) cells.push_back(Fields("ms", method.ran ? shown_ms(ms) : "-"));
    row.set("cells", cells);
    rows.push_back(row);
    y += kRow;
  }
  for (const Stage& stage : kStages) {
    Fields one;
    one.set("id", stage.id);
    one.set("name", stage.name);
    one.set("text", stage.text);
    stages.push_back(one);
  }
  const double step = step_of(end);
  const int steps = static_cast<int>(end * 1.0001 / step);
  for (int i = 0; i <= steps; ++i) {
    const double ms = i * step;
    Fields tick;
    tick.set("x", coordinate(kLabels + kPlotWidth * ms / end));
    tick.set("label", fmt::format("{:g}", ms));
    ticks.push_back(tick);
  }
  Fields fields;
  fields.set("height", coordinate(y + 4));
  fields.set("bottom", coordinate(y - 6));
  fields.set("rows", rows);
  fields.set("stages", stages);
  fields.set("ticks", ticks);
  return fields;
}

}  // namespace raysheaf::app
