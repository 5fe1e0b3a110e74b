#include "compare/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "console.h"
#include "plot/axis.h"
#include "plot/svg.h"

namespace raysheaf::app {
namespace {

constexpr double kMargin = 36, kHead = 120;
constexpr const char* kQuiet = "#7a828a";
constexpr const char* kOurs = "#c2334d";
constexpr const char* kTheirs = "#3b82c4";
constexpr const char* kKindColors[] = {"#e8890c", "#3b82c4", "#8e5bb5", "#12886f", "#c2334d"};

const char* color_of(CompareKind kind) {
  return kKindColors[static_cast<std::size_t>(kind)];
}

double shown(std::size_t count) {
  return static_cast<double>(count);
}

void include(Axis& axis, double value) {
  axis.low = std::min(axis.low, value);
  axis.high = std::max(axis.high, value);
}

/// 1, 2 and 5 of each decade; only the decades if there are more than two.
std::vector<double> ticks(const Axis& axis) {
  const bool few = axis.high / axis.low < 150;
  std::vector<double> all;
  const int last = static_cast<int>(std::floor(std::log10(axis.high)));
  for (int decade = static_cast<int>(std::floor(std::log10(axis.low))); decade <= last; ++decade)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double value = digit * std::pow(10, decade);
      if ((few || digit == 1) && value >= axis.low * 0.999 && value <= axis.high * 1.001)
        all.push_back(value);
    }
  return all;
}

std::string short_number(double value) {
  if (value >= 999'500) return fmt::format("{:.3g} M", value / 1e6);
  if (value >= 1e4) return fmt::format("{:.3g} k", value / 1e3);
  return fmt::format("{:g}", value);
}

// ---- ratios

constexpr double kNames = 210, kRatios = 560, kRowHeight = 24, kPanelHead = 52, kPanelGap = 34;

std::vector<std::string> scenes_in(const CompareReport& report, CompareMode mode) {
  std::vector<std::string> names;
  for (const CompareCase& c : report.cases)
    if (c.mode == mode && std::find(names.begin(), names.end(), label_of(c)) == names.end())
      names.push_back(label_of(c));
  return names;
}

std::vector<CompareMode> modes_in(const CompareReport& report) {
  std::vector<CompareMode> modes;
  for (const CompareMode mode : all_compare_modes())
    if (!scenes_in(report, mode).empty()) modes.push_back(mode);
  return modes;
}

std::string mode_title(CompareMode mode) {
  switch (mode) {
    case CompareMode::kRebuild:
      return "rebuild: new vertices and indices in every frame";
    case CompareMode::kRefit:
      return "refit: new vertices in every frame";
    case CompareMode::kStatic:
      break;
  }
  return "static: only the rays are new";
}

/// One axis for all panels, so that they can be compared. It always includes 1.
Axis ratio_axis(const CompareReport& report) {
  Axis axis{0.5, 2, kMargin + kNames, kMargin + kNames + kRatios};
  for (const CompareCase& c : report.cases) include(axis, c.peer.ratio);
  axis.low /= 1.15;
  axis.high *= 1.15;
  return axis;
}

/// A dot, and a stroke at its limit.
void draw_dot(SvgSheet& sheet, const Axis& x, double y, const CompareCase& c) {
  const char* color = color_of(c.kind);
  if (const std::optional<double> limit = limit_of(c); limit && misses_limit(c))
    sheet.line(x.at(std::clamp(*limit, x.low, x.high)), y, x.at(c.peer.ratio), y,
               fmt::format("stroke=\"{}\" stroke-width=\"1.6\" stroke-opacity=\"0.45\"", color));
  sheet.raw(
      fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.6\" fill=\"{}\" "
                  "fill-opacity=\"{}\" stroke=\"{}\" stroke-width=\"1.4\"/>\n",
                  x.at(c.peer.ratio), y, color, misses_limit(c) ? "0.1" : "0.9", color));
}

void draw_panel(SvgSheet& sheet, const CompareReport& report, CompareMode mode, const Axis& x,
                double top) {
  const std::vector<std::string> scenes = scenes_in(report, mode);
  sheet.text(kMargin, top + 16, mode_title(mode), {16, "#1c2125", "start", true});
  const double first = top + kPanelHead, last = first + kRowHeight * shown(scenes.size());
  for (const double tick : ticks(x)) {
    const bool one = std::fabs(tick - 1) < 1e-9;
    sheet.line(
        x.at(tick), first - 8, x.at(tick), last,
        one ? "stroke=\"#4a5157\" stroke-width=\"1.2\"" : "stroke=\"#e6e7e3\" stroke-width=\"1\"");
    sheet.text(x.at(tick), first - 13, fmt::format("{:g}", tick), {11, kQuiet, "middle"});
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const double y = first + kRowHeight * (shown(i) + 0.5);
    sheet.line(x.from, y, x.to, y, "stroke=\"#f0f0ec\" stroke-width=\"1\"");
    double triangles = 0;
    for (const CompareCase& c : report.cases) {
      if (c.mode != mode || label_of(c) != scenes[i]) continue;
      draw_dot(sheet, x, y, c);
      triangles = shown(c.triangles);
    }
    sheet.text(x.from - 62, y + 4, printable(scenes[i]), {12.5, "#2b2f33", "end"});
    sheet.text(x.from - 12, y + 4, short_number(triangles), {11, kQuiet, "end"});
  }
}

// ---- growth

constexpr double kPlot = 430, kPlotHeight = 300, kPlotLeft = 62, kPlotBelow = 62;

double count_of(const CompareCase& c, const std::string& along) {
  return shown(along == "rays" ? c.rays : c.triangles);
}

struct GrowthPanel {
  std::string along;
  CompareMode mode;
  CompareKind kind;
  std::vector<const CompareCase*> line;
};

std::vector<GrowthPanel> panels_of(const CompareReport& report) {
  std::vector<GrowthPanel> all;
  for (const CompareMode mode : all_compare_modes())
    for (const CompareKind kind : all_compare_kinds())
      for (const char* along : {"triangles", "rays"}) {
        GrowthPanel panel{along, mode, kind, growth_line(report, along, mode, kind)};
        if (!panel.line.empty()) all.push_back(std::move(panel));
      }
  return all;
}

void draw_grid(SvgSheet& sheet, const Axis& x, const Axis& y, const std::string& along) {
  constexpr const char* kGrid = "stroke=\"#e6e7e3\" stroke-width=\"1\"";
  for (const double tick : ticks(x)) {
    sheet.line(x.at(tick), y.from, x.at(tick), y.to, kGrid);
    sheet.text(x.at(tick), y.from + 17, short_number(tick), {11, kQuiet, "middle"});
  }
  for (const double tick : ticks(y)) {
    sheet.line(x.from, y.at(tick), x.to, y.at(tick), kGrid);
    sheet.text(x.from - 8, y.at(tick) + 4, fmt::format("{:g}", tick), {11, kQuiet, "end"});
  }
  sheet.text((x.from + x.to) / 2, y.from + 36, along, {12, "#4a5157", "middle"});
  sheet.upright_text(x.from - 46, (y.from + y.to) / 2, "ms", {12, "#4a5157", "middle"});
}

template <class Time>
void draw_line(SvgSheet& sheet, const GrowthPanel& panel, const Axis& x, const Axis& y,
               const char* color, const Time& time) {
  std::string places;
  for (const CompareCase* c : panel.line)
    places += fmt::format("{:.1f},{:.1f} ", x.at(count_of(*c, panel.along)), y.at(time(*c)));
  sheet.raw(fmt::format(
      "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", places, color));
  for (const CompareCase* c : panel.line)
    sheet.raw(fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.4\" fill=\"{}\"/>\n",
                          x.at(count_of(*c, panel.along)), y.at(time(*c)), color));
}

double our_time(const CompareCase& c) {
  return std::max(c.ours_ms.total, 1e-4);
}

double their_time(const CompareCase& c) {
  return std::max(c.peer.ms.total, 1e-4);
}

/// A line from the library's last point downwards, clipped to the plot.
void draw_linear(SvgSheet& sheet, const GrowthPanel& panel, const Axis& x, const Axis& y) {
  const CompareCase& last = *panel.line.back();
  const double end = count_of(last, panel.along),
               start = count_of(*panel.line.front(), panel.along);
  const double factor = std::min(end / start, our_time(last) / y.low);
  sheet.line(x.at(end), y.at(our_time(last)), x.at(end / factor), y.at(our_time(last) / factor),
             "stroke=\"#9aa1a8\" stroke-width=\"1.2\" stroke-dasharray=\"4 4\"");
}

void draw_growth(SvgSheet& sheet, const GrowthPanel& panel, double left, double top) {
  Axis x{1e300, 0, left + kPlotLeft, left + kPlotLeft + kPlot};
  Axis y{1e300, 0, top + 34 + kPlotHeight, top + 34};
  for (const CompareCase* c : panel.line) {
    include(x, count_of(*c, panel.along));
    include(y, our_time(*c));
    include(y, their_time(*c));
  }
  for (Axis* axis : {&x, &y}) {
    axis->low /= 1.4;
    axis->high *= 1.4;
  }
  sheet.text(left, top + 16,
             fmt::format("{} rays, {}, along {}", to_string(panel.kind), to_string(panel.mode),
                         panel.along),
             {15, "#1c2125", "start", true});
  draw_grid(sheet, x, y, panel.along);
  draw_linear(sheet, panel, x, y);
  draw_line(sheet, panel, x, y, kTheirs, their_time);
  draw_line(sheet, panel, x, y, kOurs, our_time);
}

double legend(SvgSheet& sheet, double x, double y, const char* color, const std::string& name) {
  sheet.raw(
      fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"{}\"/>\n", x, y - 4, color));
  sheet.text(x + 10, y, name, {12.5});
  return x + 34 + 6.8 * shown(name.size());
}

}  // namespace

std::vector<const CompareCase*> growth_line(const CompareReport& report, const std::string& along,
                                            CompareMode mode, CompareKind kind) {
  std::vector<const CompareCase*> line;
  for (const GrowthCase& g : report.growth)
    if (g.along == along && g.measured.mode == mode && g.measured.kind == kind)
      line.push_back(&g.measured);
  std::sort(line.begin(), line.end(), [&](const CompareCase* a, const CompareCase* b) {
    return count_of(*a, along) < count_of(*b, along);
  });
  return line;
}

double steepest(const std::vector<const CompareCase*>& line, const std::string& along,
                bool theirs) {
  double most = 0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const auto time = [&](const CompareCase* c) { return theirs ? their_time(*c) : our_time(*c); };
    const double more = count_of(*line[i], along) / count_of(*line[i - 1], along);
    if (more > 1)
      most = std::max(most, std::log(time(line[i]) / time(line[i - 1])) / std::log(more));
  }
  return most;
}

std::string compare_svg(const CompareReport& report) {
  double height = kHead + kMargin / 2;
  const std::vector<CompareMode> modes = modes_in(report);
  const auto panel_height = [&](CompareMode mode) {
    return kPanelHead + kRowHeight * shown(scenes_in(report, mode).size()) + kPanelGap;
  };
  for (const CompareMode mode : modes) height += panel_height(mode);
  SvgSheet sheet(2 * kMargin + kNames + kRatios, height);
  sheet.text(kMargin, 44, "Time compared with " + report.peer, {24, "#1c2125", "start", true});
  sheet.text(kMargin, 66,
             fmt::format("ours / theirs, {} threads: left of 1 the library is ahead. Hollow dots "
                         "exceed a limit; their stroke begins there.",
                         report.threads),
             {13, kQuiet});
  double x = kMargin + 6;
  for (const CompareKind kind : all_compare_kinds())
    x = legend(sheet, x, 96, color_of(kind), to_string(kind));
  const Axis axis = ratio_axis(report);
  double top = kHead;
  for (const CompareMode mode : modes) {
    draw_panel(sheet, report, mode, axis, top);
    top += panel_height(mode);
  }
  return sheet.finished();
}

std::string growth_svg(const CompareReport& report) {
  const std::vector<GrowthPanel> panels = panels_of(report);
  const double width = kPlotLeft + kPlot + 30, height = 34 + kPlotHeight + kPlotBelow;
  const double columns = shown(std::clamp<std::size_t>(panels.size(), 1, 2));
  SvgSheet sheet(2 * kMargin + columns * width, kHead + shown((panels.size() + 1) / 2) * height);
  sheet.text(kMargin, 44, "Growth compared with " + report.peer, {24, "#1c2125", "start", true});
  sheet.text(kMargin, 66, fmt::format("a frame in a generated hall, {} threads", report.threads),
             {13, kQuiet});
  const double x = legend(sheet, kMargin + 6, 96, kOurs, "raysheaf");
  (void)legend(sheet, legend(sheet, x, 96, kTheirs, report.peer), 96, "#9aa1a8",
               "dashed: linear growth");
  for (std::size_t i = 0; i < panels.size(); ++i)
    draw_growth(sheet, panels[i], kMargin + shown(i % 2) * width, kHead + shown(i / 2) * height);
  return sheet.finished();
}

}  // namespace raysheaf::app
