#include "report/bundles.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace raysheaf::app {
namespace {

struct Range {
  int first, last;  ///< exponents of the first and the last bin
};
constexpr Range kDegrees = {-7, 7}, kPercent = {-7, 6}, kLoose = {-2, 11};

struct Weighted {
  double value, weight;
};

double quantile(const std::vector<Weighted>& sorted, double total, double part) {
  double below = 0;
  for (const Weighted& w : sorted) {
    below += w.weight;
    if (below >= part * total) return w.value;
  }
  return sorted.empty() ? 0 : sorted.back().value;
}

Histogram histogram(std::vector<Weighted> values, Range range) {
  Histogram h;
  h.first = range.first;
  h.shares.resize(static_cast<std::size_t>(range.last - range.first) + 1);
  double total = 0;
  for (const Weighted& w : values) total += w.weight;
  if (!(total > 0)) return h;
  for (const Weighted& w : values) {
    const int exponent =
        w.value > 0 ? static_cast<int>(std::floor(std::log2(w.value))) : range.first;
    const int bin = std::clamp(exponent, range.first, range.last) - range.first;
    h.shares[static_cast<std::size_t>(bin)] += w.weight / total;
  }
  std::sort(values.begin(), values.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  h.low = quantile(values, total, 0.1);
  h.median = quantile(values, total, 0.5);
  h.high = quantile(values, total, 0.9);
  return h;
}

/// Samples of one level, batch by batch, with their weights.
struct Gathered {
  std::vector<Weighted> degrees, percent, loose;
  double rays = 0, accepted = 0, needed = 0;

  void add(const BundleSample& s, double weight) {
    degrees.push_back({s.direction_spread, weight});
    percent.push_back({100.0 * s.origin_spread, weight});
    if (s.needed > 0) loose.push_back({s.looseness(), weight});
    rays += s.rays;
    // A sample represents `weight / rays` bundles of its own size.
    accepted += weight / s.rays * static_cast<double>(s.accepted);
    needed += weight / s.rays * static_cast<double>(s.needed);
  }
};

void gather(const BatchStatistics& batch, std::map<std::uint32_t, Gathered>* levels) {
  std::map<std::uint32_t, std::size_t> counts;
  for (const BundleSample& s : batch.bundles) ++counts[s.level];
  for (const BundleSample& s : batch.bundles)
    (*levels)[s.level].add(s,
                           static_cast<double>(batch.rays) / static_cast<double>(counts[s.level]));
}

}  // namespace

std::vector<BundleLevel> bundle_levels(const Report& report) {
  std::vector<BundleLevel> all;
  for (const MethodReport& method : report.methods) {
    std::map<std::uint32_t, Gathered> levels;
    for (const BatchStatistics& batch : method.counted.batches) gather(batch, &levels);
    for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
      const Gathered& g = level->second;
      BundleLevel one;
      one.method = method.method;
      one.level = level->first;
      one.only_level = levels.size() == 1;
      one.samples = g.degrees.size();
      one.mean_rays = g.rays / static_cast<double>(g.degrees.size());
      one.looseness = g.needed > 0 ? g.accepted / g.needed : 0;
      one.direction_degrees = histogram(g.degrees, kDegrees);
      one.origin_percent = histogram(g.percent, kPercent);
      one.loose = histogram(g.loose, kLoose);
      all.push_back(std::move(one));
    }
  }
  return all;
}

}  // namespace raysheaf::app
