#include "queries/picture_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

}  // namespace

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
