#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plot/axis.h"
#include "plot/plots.h"
#include "plot/svg.h"

namespace raysheaf::app {
namespace {

constexpr double kMargin = 36, kHead = 150, kPlotWidth = 480, kPlotHeight = 340;
constexpr double kAxisLeft = 62, kAxisBelow = 46, kPlotHead = 34, kBetween = 34;
constexpr double kNoteLetter = 6.9;
constexpr const char* kQuiet = "#7a828a";
constexpr const char* kColors[] = {"#adb5bd", "#3b82c4", "#e8890c", "#8e5bb5",
                                   "#12886f", "#c2334d", "#5c4a3d"};

double shown(std::size_t count) {
  return static_cast<double>(count);
}

Axis axis_over(const std::vector<Scatter::Point>& points, double Scatter::Point::*coordinate,
               double from, double to) {
  Axis axis{0, 0, from, to};
  for (const Scatter::Point& p : points) {
    axis.low = axis.low > 0 ? std::min(axis.low, p.*coordinate) : p.*coordinate;
    axis.high = std::max(axis.high, p.*coordinate);
  }
  if (!(axis.low > 0)) axis.low = axis.high = 1;
  const double margin = std::max(std::pow(axis.high / axis.low, 0.07), 1.1);
  axis.low /= margin;
  axis.high *= margin;
  return axis;
}

std::vector<double> ticks_at(const Axis& axis, const std::vector<double>& digits) {
  std::vector<double> all;
  double decade = std::pow(10, std::floor(std::log10(axis.low)));
  while (decade <= axis.high) {
    for (const double digit : digits)
      if (decade * digit >= axis.low && decade * digit <= axis.high) all.push_back(decade * digit);
    decade *= 10;
  }
  return all;
}

/// The coarsest digits of each decade that give three ticks.
std::vector<double> ticks(const Axis& axis) {
  for (const std::vector<double>& digits :
       {std::vector<double>{1}, {1, 2, 5}, {1, 1.5, 2, 3, 4, 5, 7}}) {
    std::vector<double> all = ticks_at(axis, digits);
    if (all.size() >= 3) return all;
  }
  std::vector<double> tenths;
  for (int i = 10; i < 100; ++i) tenths.push_back(i / 10.0);
  return ticks_at(axis, tenths);
}

/// Two digits if the second is not 0, without an exponent.
std::string tick_text(double value) {
  std::string text = fmt::format(
      "{:.{}f}", value, std::max(0, static_cast<int>(1 - std::floor(std::log10(value) + 1e-9))));
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// A mark of the seven shapes about (x, y).
std::string mark(std::size_t shape, double x, double y, const char* color) {
  const std::string paint = fmt::format(
      "fill=\"{}\" fill-opacity=\"0.88\" stroke=\"#ffffff\" stroke-width=\"0.8\"", color);
  const auto polygon = [&](const std::vector<std::pair<double, double>>& corners) {
    std::string places;
    for (const auto& [dx, dy] : corners) places += fmt::format("{:.1f},{:.1f} ", x + dx, y + dy);
    return fmt::format("<polygon points=\"{}\" {}/>\n", places, paint);
  };
  switch (shape) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.4\" {}/>\n", x, y, paint);
    case 1:
      return polygon({{-4, -4}, {4, -4}, {4, 4}, {-4, 4}});
    case 2:
      return polygon({{0, -5.4}, {5, 4}, {-5, 4}});
    case 3:
      return polygon({{0, -5.8}, {5.8, 0}, {0, 5.8}, {-5.8, 0}});
    case 4:
      return polygon({{0, 5.4}, {5, -4}, {-5, -4}});
    case 5:
      return polygon({{-1.8, -5.4},
                      {1.8, -5.4},
                      {1.8, -1.8},
                      {5.4, -1.8},
                      {5.4, 1.8},
                      {1.8, 1.8},
                      {1.8, 5.4},
                      {-1.8, 5.4},
                      {-1.8, 1.8},
                      {-5.4, 1.8},
                      {-5.4, -1.8},
                      {-1.8, -1.8}});
    default:
      return polygon({{0, -5.6}, {5.3, -1.7}, {3.3, 4.5}, {-3.3, 4.5}, {-5.3, -1.7}});
  }
}

/// The points that no other point beats in both figures, from the left.
std::vector<Scatter::Point> unbeaten(std::vector<Scatter::Point> points) {
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<Scatter::Point> front;
  for (const Scatter::Point& p : points)
    if (front.empty() || p.y < front.back().y) front.push_back(p);
  return front;
}

void draw_axes(SvgSheet& sheet, const Axis& x, const Axis& y, const ScatterKey& key) {
  constexpr const char* kGrid = "stroke=\"#e6e7e3\" stroke-width=\"1\"";
  for (const double tick : ticks(x)) {
    sheet.line(x.at(tick), y.from, x.at(tick), y.to, kGrid);
    sheet.text(x.at(tick), y.from + 17, tick_text(tick), {11, kQuiet, "middle"});
  }
  for (const double tick : ticks(y)) {
    sheet.line(x.from, y.at(tick), x.to, y.at(tick), kGrid);
    sheet.text(x.from - 8, y.at(tick) + 4, tick_text(tick), {11, kQuiet, "end"});
  }
  sheet.line(x.from, y.from, x.to, y.from, "stroke=\"#9aa1a8\" stroke-width=\"1\"");
  sheet.line(x.from, y.from, x.from, y.to, "stroke=\"#9aa1a8\" stroke-width=\"1\"");
  sheet.text((x.from + x.to) / 2, y.from + 37, key.x, {12, "#4a5157", "middle"});
  sheet.upright_text(x.from - 46, (y.from + y.to) / 2, key.y, {12, "#4a5157", "middle"});
}

/// Labels go to the side with more room, and down until they touch no earlier label.
void draw_labels(SvgSheet& sheet, const Scatter& plot, const Axis& x, const Axis& y) {
  std::vector<double> taken;
  for (const Scatter::Point& p : plot.points) {
    if (p.label.empty()) continue;
    const double px = x.at(p.x), py = y.at(p.y);
    const bool right = px < (x.from + x.to) / 2;
    double place = py + 4;
    const auto touches = [&](double other) { return std::fabs(other - place) < 14; };
    for (int tries = 0; tries < 12; ++tries)
      if (std::any_of(taken.begin(), taken.end(), touches)) place -= 7;
    taken.push_back(place);
    const double start = px + (right ? 16 : -16);
    sheet.line(px, py, start, place - 4, "stroke=\"#2b2f33\" stroke-width=\"0.7\"");
    sheet.raw(fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11.5\" font-weight=\"600\" fill=\"#1c2125\" "
        "text-anchor=\"{}\" stroke=\"#fdfdfb\" stroke-width=\"3.5\" paint-order=\"stroke\">{}"
        "</text>\n",
        start + (right ? 3 : -3), place, right ? "start" : "end", escaped(p.label)));
  }
}

void draw(SvgSheet& sheet, const Scatter& plot, const ScatterKey& key, double left, double top) {
  sheet.text(left, top + 16, plot.title, {16, "#1c2125", "start", true});
  const double above = top + kPlotHead, below = above + kPlotHeight;
  const Axis x =
      axis_over(plot.points, &Scatter::Point::x, left + kAxisLeft, left + kAxisLeft + kPlotWidth);
  const Axis y = axis_over(plot.points, &Scatter::Point::y, below, above);
  draw_axes(sheet, x, y, key);
  std::string front;
  for (const Scatter::Point& p : unbeaten(plot.points))
    front += fmt::format("{:.1f},{:.1f} ", x.at(p.x), y.at(p.y));
  sheet.raw(
      fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"#1c2125\" "
                  "stroke-width=\"1\" stroke-dasharray=\"4 4\"/>\n",
                  front));
  for (const Scatter::Point& p : plot.points)
    sheet.raw(mark(p.shape, x.at(p.x), y.at(p.y), kColors[p.color % std::size(kColors)]));
  draw_labels(sheet, plot, x, y);
}

double legend_width(const std::string& name) {
  return 34 + 6.6 * shown(name.size());
}

void draw_legend(SvgSheet& sheet, const ScatterKey& key) {
  double x = kMargin + 8;
  for (std::size_t i = 0; i < key.colors.size(); ++i) {
    sheet.rectangle(x - 6, 87, 12, 12, fmt::format("rx=\"2\" fill=\"{}\"", kColors[i]));
    sheet.text(x + 12, 97, key.colors[i], {12.5});
    x += legend_width(key.colors[i]);
  }
  x = kMargin + 8;
  for (std::size_t i = 0; i < key.shapes.size(); ++i) {
    sheet.raw(mark(i, x, 116, "#4a5157"));
    sheet.text(x + 12, 120, key.shapes[i], {12.5});
    x += legend_width(key.shapes[i]);
  }
}

}  // namespace

std::string scatters_svg(const std::string& title, const std::string& note, const ScatterKey& key,
                         const std::vector<Scatter>& plots) {
  const std::size_t columns = std::min<std::size_t>(plots.size(), 2);
  const double width = kAxisLeft + kPlotWidth + kBetween;
  const double height = kPlotHead + kPlotHeight + kAxisBelow + 24;
  double legend = kNoteLetter * shown(note.size());
  double shapes = 0;
  for (const std::string& name : key.shapes) shapes += legend_width(name);
  legend = std::max(legend, shapes);
  SvgSheet sheet(std::max(kMargin * 2 + shown(columns) * width - kBetween, legend + 2 * kMargin),
                 kHead + shown((plots.size() + 1) / 2) * height + kMargin / 2);
  sheet.text(kMargin, 44, title, {24, "#1c2125", "start", true});
  sheet.text(kMargin, 66, note, {13, kQuiet});
  draw_legend(sheet, key);
  for (std::size_t i = 0; i < plots.size(); ++i)
    draw(sheet, plots[i], key, kMargin + shown(i % 2) * width, kHead + shown(i / 2) * height);
  return sheet.finished();
}

}  // namespace raysheaf::app
