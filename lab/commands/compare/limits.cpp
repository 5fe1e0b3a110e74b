// The ratios that the project requires of itself.
#include <array>
#include <cmath>
#include <string_view>

#include "lab/commands/compare/compare.h"

namespace raysheaf::app {
namespace {

/// For shadow, mirror, ambient occlusion and random rays; no ratio is required for second bounces.
struct LimitRow {
  CompareMode mode;
  std::uint64_t fewest, most;  ///< triangles
  double shadow, mirror, ambient_occlusion, random;
};

constexpr std::uint64_t kAnyCount = ~std::uint64_t{0};
constexpr std::uint64_t kLarge = 900'000;  ///< halls of 1 M have slightly fewer

constexpr std::array<LimitRow, 4> kLimits = {{
    {CompareMode::kRebuild, 36'000, 300'000, 0.5, 0.8, 1.0, 1.2},
    {CompareMode::kRebuild, kLarge, kAnyCount, 0.25, 0.35, 0.4, 0.5},
    {CompareMode::kRefit, 0, kAnyCount, 0.8, 1.2, 1.5, 1.5},
    {CompareMode::kStatic, 0, kAnyCount, 1.0, 1.5, 2.0, 2.0},
}};

std::optional<double> limit_in(const LimitRow& row, CompareKind kind) {
  switch (kind) {
    case CompareKind::kShadow:
      return row.shadow;
    case CompareKind::kMirror:
      return row.mirror;
    case CompareKind::kAmbientOcclusion:
      return row.ambient_occlusion;
    case CompareKind::kRandom:
      return row.random;
    case CompareKind::kSecond:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> limit_of(const CompareCase& c) {
  for (const LimitRow& row : kLimits)
    if (row.mode == c.mode && c.triangles >= row.fewest && c.triangles <= row.most)
      return limit_in(row, c.kind);
  return std::nullopt;
}

std::string row_of(const CompareCase& c) {
  const bool large = c.mode == CompareMode::kRebuild && c.triangles >= kLarge;
  return std::string(to_string(c.mode)) + (large ? "_large" : "") +
         (c.one_of_sizes ? "_" + size_text(c.size) : "");
}

bool misses_limit(const CompareCase& c) {
  const std::optional<double> limit = limit_of(c);
  return limit && c.peer.ratio > *limit;
}

double mean_ratio(const std::vector<CompareCase>& cases,
                  const std::function<bool(const CompareCase&)>& passes,
                  double PeerResult::*ratio) {
  double sum = 0;
  std::size_t count = 0;
  for (const CompareCase& c : cases) {
    if (!passes(c)) continue;
    sum += std::log(c.peer.*ratio);
    ++count;
  }
  return count == 0 ? 0 : std::exp(sum / static_cast<double>(count));
}

}  // namespace raysheaf::app
