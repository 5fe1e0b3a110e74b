#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plot/plots.h"
#include "plot/svg.h"

namespace raysheaf::app {
namespace {

constexpr double kMargin = 36, kHead = 84, kLabels = 184, kCellWidth = 78, kCellHeight = 22;
constexpr double kPlotHead = 62, kPlotFoot = 58, kBetween = 44, kGroupGap = 4;
constexpr const char* kQuiet = "#7a828a";

using Color = std::array<double, 3>;

/// Colours from few tests to many.
constexpr Color kRamp[] = {{12, 68, 84},    {24, 106, 112},  {66, 146, 134},
                           {130, 186, 160}, {192, 218, 192}, {236, 240, 222}};

Color ramp(double part) {
  constexpr int kLast = static_cast<int>(std::size(kRamp)) - 1;
  const double place = std::clamp(part, 0.0, 1.0) * kLast;
  const int low = std::min(static_cast<int>(place), kLast - 1);
  Color mixed{};
  for (std::size_t c = 0; c < 3; ++c)
    mixed[c] = kRamp[low][c] + (kRamp[low + 1][c] - kRamp[low][c]) * (place - low);
  return mixed;
}

std::string hex(const Color& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", std::lround(color[0]), std::lround(color[1]),
                     std::lround(color[2]));
}

struct Range {
  double low = 0, high = 0;
  [[nodiscard]] double part(double value) const {
    return high > low ? std::log(value / low) / std::log(high / low) : 0;
  }
};

Range range_of(const HeatMap& map) {
  Range range;
  for (const HeatMap::Row& row : map.rows) {
    for (const double value : row.values) {
      if (!(value > 0)) continue;
      range.low = range.low > 0 ? std::min(range.low, value) : value;
      range.high = std::max(range.high, value);
    }
  }
  return range;
}

bool goes_on(const HeatMap& map, std::size_t row) {
  return row > 0 && map.rows[row].name == map.rows[row - 1].name;
}

double height_of(const HeatMap& map) {
  double height = kPlotHead + kPlotFoot;
  for (std::size_t r = 0; r < map.rows.size(); ++r)
    height += kCellHeight + (goes_on(map, r) ? 0 : kGroupGap);
  return height;
}

double width_of(const HeatMap& map) {
  return kLabels + kCellWidth * static_cast<double>(map.columns.size());
}

void draw_cell(SvgSheet& sheet, double x, double y, double value, const Range& range) {
  if (!(value > 0)) {
    sheet.rectangle(x + 1, y + 1, kCellWidth - 2, kCellHeight - 2, "rx=\"2\" fill=\"#f1f1ee\"");
    return;
  }
  const double part = range.part(value);
  const bool least = value <= range.low;
  sheet.rectangle(x + 1, y + 1, kCellWidth - 2, kCellHeight - 2,
                  fmt::format("rx=\"2\" fill=\"{}\"{}", hex(ramp(part)),
                              least ? " stroke=\"#f08c00\" stroke-width=\"3\"" : ""));
  sheet.text(x + kCellWidth / 2, y + kCellHeight / 2 + 4.2, three_digits(value),
             {12, part < 0.5 ? "#ffffff" : "#20302f", "middle", least});
}

void draw_scale(SvgSheet& sheet, double x, double y, const Range& range) {
  constexpr int kSteps = 40;
  constexpr double kStep = 4;
  for (int i = 0; i < kSteps; ++i)
    sheet.rectangle(x + kStep * i, y, kStep + 0.5, 8,
                    fmt::format("fill=\"{}\"", hex(ramp((i + 0.5) / kSteps))));
  sheet.text(x - 8, y + 8, three_digits(range.low), {11, kQuiet, "end"});
  sheet.text(x + kStep * kSteps + 8, y + 8, three_digits(range.high) + " %", {11, kQuiet});
}

void draw(SvgSheet& sheet, const HeatMap& map, double left, double top) {
  const Range range = range_of(map);
  sheet.text(left, top + 16, map.title, {16, "#1c2125", "start", true});
  sheet.text(left, top + 35, map.note, {12, kQuiet});
  for (std::size_t c = 0; c < map.columns.size(); ++c)
    sheet.text(left + kLabels + kCellWidth * (static_cast<double>(c) + 0.5), top + kPlotHead - 4,
               map.columns[c], {12, "#2b2f33", "middle"});
  double y = top + kPlotHead;
  for (std::size_t r = 0; r < map.rows.size(); ++r) {
    const HeatMap::Row& row = map.rows[r];
    if (!goes_on(map, r)) {
      y += kGroupGap;
      sheet.text(left, y + kCellHeight / 2 + 4.2, row.name, {12});
    }
    sheet.text(left + kLabels - 10, y + kCellHeight / 2 + 4.2, row.detail, {11, kQuiet, "end"});
    for (std::size_t c = 0; c < row.values.size(); ++c)
      draw_cell(sheet, left + kLabels + kCellWidth * static_cast<double>(c), y, row.values[c],
                range);
    y += kCellHeight;
  }
  if (range.high > range.low) draw_scale(sheet, left + kLabels + 36, y + 16, range);
}

}  // namespace

std::string heat_maps_svg(const std::string& title, const std::string& note,
                          const std::vector<HeatMap>& maps) {
  double width = 0, height = 0;
  for (const HeatMap& map : maps) {
    width = std::max(width, width_of(map));
    height = std::max(height, height_of(map));
  }
  const std::size_t columns = std::min<std::size_t>(maps.size(), 2);
  const std::size_t rows = (maps.size() + 1) / 2;
  SvgSheet sheet(
      std::max(2 * kMargin + static_cast<double>(columns) * (width + kBetween) - kBetween,
               6.9 * static_cast<double>(note.size()) + 2 * kMargin),
      kHead + static_cast<double>(rows) * height + kMargin / 2);
  sheet.text(kMargin, 44, title, {24, "#1c2125", "start", true});
  sheet.text(kMargin, 66, note, {13, kQuiet});
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::size_t column = i % 2, row = i / 2;
    draw(sheet, maps[i], kMargin + static_cast<double>(column) * (width + kBetween),
         kHead + 14 + static_cast<double>(row) * height);
  }
  return sheet.finished();
}

}  // namespace raysheaf::app
