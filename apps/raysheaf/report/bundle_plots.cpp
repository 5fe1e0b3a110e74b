#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/support/table.h"
#include "report/fields.h"

namespace raysheaf::app {
namespace {

constexpr double kWidth = 240, kBase = 60, kTop = 6;

struct Measure {
  const char *id, *title, *unit;
  Histogram BundleLevel::*histogram;
};
constexpr Measure kMeasures[] = {
    {"degrees", "angle between its rays", "degrees", &BundleLevel::direction_degrees},
    {"percent", "distance between its origins", "% of the scene", &BundleLevel::origin_percent},
    {"loose", "looseness of its bound", "times", &BundleLevel::loose}};

std::string name_of(const BundleLevel& level) {
  const std::string method = to_string(level.method);
  return level.only_level ? method : fmt::format("{}, level {}", method, level.level);
}

/// The bins that any row uses, because all rows share an axis.
std::pair<std::size_t, std::size_t> used(const std::vector<BundleLevel>& levels,
                                         const Measure& measure) {
  std::size_t first = 1000, last = 0;
  for (const BundleLevel& level : levels) {
    const std::vector<double>& shares = (level.*measure.histogram).shares;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      if (!(shares[i] > 0)) continue;
      first = std::min(first, i);
      last = std::max(last, i);
    }
  }
  return first > last ? std::pair<std::size_t, std::size_t>{0, 0} : std::pair{first, last};
}

double largest_share(const std::vector<BundleLevel>& levels, const Measure& measure) {
  double most = 1e-9;
  for (const BundleLevel& level : levels)
    for (const double share : (level.*measure.histogram).shares) most = std::max(most, share);
  return most;
}

/// Three digits, without digits that are almost 0.
std::string shown(double value) {
  return value < 5e-4 ? "0" : three_digits(value);
}

std::string shown_bin(int exponent) {
  if (exponent < 0) return fmt::format("1/{}", 1 << -exponent);
  return std::to_string(1 << exponent);
}

Fields ticks_of(const Histogram& h, std::size_t first, std::size_t count) {
  Fields ticks = list_of_fields();
  const std::size_t step = std::max<std::size_t>(1, (count + 4) / 5);
  for (std::size_t i = 0; i <= count; i += step) {
    Fields tick;
    tick.set("x", coordinate(kWidth * static_cast<double>(i) / static_cast<double>(count)));
    // The very first bin begins at 0.
    tick.set("label", first + i == 0 ? "0" : shown_bin(h.first + static_cast<int>(first + i)));
    tick.set("anchor", i == 0 ? "start" : i == count ? "end" : "middle");
    ticks.push_back(tick);
  }
  return ticks;
}

Fields drawn(const BundleLevel& level, const Measure& measure,
             const std::vector<BundleLevel>& levels) {
  const Histogram& h = level.*measure.histogram;
  const auto [first, last] = used(levels, measure);
  const std::size_t count = last - first + 1;
  const double bin = kWidth / static_cast<double>(count), most = largest_share(levels, measure);
  Fields bars = list_of_fields();
  for (std::size_t i = 0; i < count; ++i) {
    const double share = h.shares[first + i], height = (kBase - kTop) * share / most;
    const int exponent = h.first + static_cast<int>(first + i);
    Fields bar;
    bar.set("x", coordinate(bin * static_cast<double>(i) + 0.5));
    bar.set("y", coordinate(kBase - height));
    bar.set("width", coordinate(bin - 1));
    bar.set("height", coordinate(height));
    const std::string from = first + i == 0 ? "0" : shown_bin(exponent);
    bar.set("title", fmt::format("{} to {} {}: {} % of the rays", from, shown_bin(exponent + 1),
                                 measure.unit, three_digits(100 * share)));
    if (share > 0) bars.push_back(bar);
  }
  const double place =
      h.median > 0 ? std::log2(h.median) - h.first - static_cast<double>(first) : 0;
  Fields fields;
  fields.set("measure", measure.title);
  fields.set("unit", measure.unit);
  fields.set("bars", bars);
  fields.set("ticks", ticks_of(h, first, count));
  fields.set("median", shown(h.median));
  fields.set("median_x", coordinate(std::clamp(place * bin, 0.0, kWidth)));
  return fields;
}

std::string spread(const Histogram& h) {
  return shown(h.median) + " (" + shown(h.low) + " to " + shown(h.high) + ")";
}

}  // namespace

Fields bundle_plots(const std::vector<BundleLevel>& levels) {
  Fields rows = list_of_fields();
  for (const BundleLevel& level : levels) {
    Fields row, plots = list_of_fields();
    row.set("name", name_of(level));
    row.set("method", to_string(level.method));
    row.set("samples", std::to_string(level.samples));
    row.set("rays", three_digits(level.mean_rays));
    row.set("degrees", spread(level.direction_degrees));
    row.set("percent", spread(level.origin_percent));
    row.set("loose", spread(level.loose));
    row.set("overall", three_digits(level.looseness));
    for (const Measure& measure : kMeasures) {
      Fields plot = drawn(level, measure, levels);
      plot.set("name", name_of(level));
      plots.push_back(plot);
    }
    row.set("plots", plots);
    rows.push_back(row);
  }
  Fields fields;
  fields.set("rows", rows);
  fields.set("any", !levels.empty());
  return fields;
}

}  // namespace raysheaf::app
