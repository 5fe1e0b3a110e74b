#include "queries/ray_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/vec.h"
#include "methods/dual/ray_order.h"

namespace raysheaf {
namespace {

constexpr std::size_t kShortestRow = 32, kRows = 8, kPiece = 512, kSamples = 32;
/// A row may end where the distance to the next ray is more than kJump times the median.
constexpr float kJump = 8;
/// Rows are adjacent if the median distance to the ray below is at most kStepDown times that to the
/// next ray.
constexpr float kStepDown = 3;
/// Silhouettes look like ends of rows: so many are tried.
constexpr int kMostTried = 16;

/// The distance between two rays, without a unit.
float distance(const Ray& a, const Ray& b) {
  const auto far = [](Vec3 p, Vec3 q) {
    return std::fabs(p.x - q.x) + std::fabs(p.y - q.y) + std::fabs(p.z - q.z);
  };
  const float all = far(a.origin, b.origin) + far(a.direction, b.direction);
  return std::isnan(all) ? std::numeric_limits<float>::infinity() : all;
}

/// The median of the distances between rays i and i + `apart`, both before `end`, from a sample.
float median_distance(const RaySource& rays, std::size_t end, std::size_t apart) {
  std::array<float, kSamples> found;
  for (std::size_t k = 0; k < kSamples; ++k) {
    // A multiple of the golden ratio, so that no length of rows puts all samples into one column.
    const auto part = static_cast<std::uint32_t>(k + 1) * 2654435769u;
    const std::size_t i = part * (std::uint64_t{end} - apart) >> 32;
    Ray a, b;
    found[k] = distance(rays.peek(i, i + 1, &a)[0], rays.peek(i + apart, i + apart + 1, &b)[0]);
  }
  std::nth_element(found.begin(), found.begin() + kSamples / 2, found.end());
  return found[kSamples / 2];
}

/// The first ray from `begin` on that is farther from its predecessor than `least`; or `end`.
std::size_t find_jump(const RaySource& rays, std::size_t begin, std::size_t end, float least) {
  std::array<Ray, kPiece> room;
  for (std::size_t first = begin - 1; first + 1 < end; first += kPiece - 1) {
    const View<const Ray> some = rays.peek(first, std::min(first + kPiece, end), room.data());
    for (std::size_t i = 1; i < some.size; ++i)
      if (distance(some[i - 1], some[i]) > least) return first + i;
  }
  return end;
}

constexpr std::size_t kGroups = 64, kFewestGroups = 8;

/// The longest side, in binary64, where that of any box is finite.
double extent(Vec3 low, Vec3 high) {
  const double x = static_cast<double>(high.x) - low.x, y = static_cast<double>(high.y) - low.y;
  return std::max({x, y, static_cast<double>(high.z) - low.z});
}

/// Where a sampled group begins in its part of the batch, from 0 to `most`, by a hash (M. O'Neill,
/// "PCG", 2014): at equal distances, all groups of an image could lie in one column.
std::size_t offset_of_group(std::size_t group, std::size_t most) {
  constexpr std::uint32_t kSeed = 14 * 64;  // spreads well over images 128 to 1920 pixels wide
  const std::uint32_t state =
      (kSeed + static_cast<std::uint32_t>(group)) * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
  return static_cast<std::size_t>(std::uint64_t{(word >> 22) ^ word} * most >> 32);
}

}  // namespace

Coherence sample_coherence(const RaySource& rays, const Box* whole) {
  constexpr std::size_t kGroup = 16;
  // Fewer groups for a small batch: sampling it must cost less than tracing it.
  const std::size_t groups =
      std::min({kGroups, rays.size() / kGroup, kFewestGroups + rays.size() / 512});
  if (groups == 0) return {};
  const std::size_t stride = rays.size() / groups;
  Vec3 low, high;
  std::array<double, kGroups> extents{};
  double alike = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    Vec3 o0, o1, d0, d1;
    std::uint32_t first = 0, same = 0;
    std::array<Ray, kGroup> room;
    const std::size_t begin = g * stride + offset_of_group(g, stride - kGroup);
    const View<const Ray> group = rays.peek(begin, begin + kGroup, room.data());
    for (std::size_t i = 0; i < kGroup; ++i) {
      const Ray& ray = group[i];
      const Vec3 d = ray.direction / max_component(abs(ray.direction));
      if (i == 0) first = quarter_of(d);
      same += quarter_of(d) == first ? 1 : 0;
      o0 = i == 0 ? ray.origin : min(o0, ray.origin);
      o1 = i == 0 ? ray.origin : max(o1, ray.origin);
      d0 = i == 0 ? d : min(d0, d);
      d1 = i == 0 ? d : max(d1, d);
    }
    low = g == 0 ? o0 : min(low, o0);
    high = g == 0 ? o1 : max(high, o1);
    extents[g] = extent(o0, o1);
    if (std::isnan(extents[g])) extents[g] = 0;
    alike += same == kGroup && max_component(d1 - d0) < 0.5f ? 1 : 0;
  }
  // The median, because a silhouette between neighbours does not make rays incoherent.
  std::nth_element(extents.begin(), extents.begin() + groups / 2, extents.begin() + groups);
  const double size = whole != nullptr ? extent(whole->min, whole->max) : extent(low, high);
  return {size > 0 ? extents[groups / 2] / size : 0, alike / static_cast<double>(groups)};
}

std::size_t find_picture_row(const RaySource& rays) {
  const std::size_t end = std::min(rays.size() / kRows, kLongestRow) + 1;
  if (end <= kShortestRow) return 0;
  const auto median = [&](std::size_t apart) { return median_distance(rays, rays.size(), apart); };
  const float jump = kJump * median_distance(rays, end, 1), most = kStepDown * median(1);
  std::size_t row = kShortestRow;
  for (int tried = 0; tried < kMostTried; ++tried, ++row) {
    row = find_jump(rays, row, end, jump);
    if (row == end) return 0;
    const float down = median(row);
    if (down <= most && down < median(row - 1) && down < median(row + 1) && down < median(row / 2))
      return row;
  }
  return 0;
}

}  // namespace raysheaf
