#include "latency.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace raysheaf::viewer {
namespace {

constexpr double kClassMs = 5;
constexpr std::size_t kMostClasses = 12, kBarLength = 50;

}  // namespace

double Latency::percentile(double part) const {
  if (all_.empty()) return 0;
  std::vector<double> sorted = all_;
  const auto place = static_cast<std::size_t>(
      std::ceil(std::clamp(part, 0.0, 1.0) * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(place, 1) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

std::string Latency::histogram() const {
  char line[160];
  std::snprintf(line, sizeof line,
                "input to present: %zu events, median %.1f ms, 95 %% %.1f ms, 99 %% %.1f ms, "
                "largest %.1f ms\n",
                all_.size(), percentile(0.5), percentile(0.95), percentile(0.99), largest());
  std::string text = line;
  std::vector<std::size_t> classes(kMostClasses + 1);
  for (const double ms : all_)
    ++classes[std::min(static_cast<std::size_t>(std::max(ms, 0.0) / kClassMs), kMostClasses)];
  const std::size_t most =
      std::max<std::size_t>(1, *std::max_element(classes.begin(), classes.end()));
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (classes[c] == 0) continue;
    const int from = static_cast<int>(static_cast<double>(c) * kClassMs);
    std::snprintf(line, sizeof line, "  %3d ms%s %6zu  ", from, c == kMostClasses ? "+" : " ",
                  classes[c]);
    text += line + std::string((classes[c] * kBarLength + most - 1) / most, '#') + "\n";
  }
  return text;
}

}  // namespace raysheaf::viewer
