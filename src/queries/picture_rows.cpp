#include "queries/picture_rows.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace raysheaf {
namespace {

constexpr std::size_t kShortestRow = 32, kRows = 8, kPiece = 512;
/// A row ends where the distance to the next ray is more than kJump times the longest step within
/// the row, and the next ray is within kStepDown average steps of the row's first ray.
constexpr float kJump = 8, kStepDown = 2;

/// Distances between consecutive rays.
struct Steps {
  float longest = 0, sum = 0;
};

/// The distance between two rays, without a unit.
float distance(const Ray& a, const Ray& b) {
  const auto far = [](Vec3 p, Vec3 q) {
    return std::fabs(p.x - q.x) + std::fabs(p.y - q.y) + std::fabs(p.z - q.z);
  };
  return far(a.origin, b.origin) + far(a.direction, b.direction);
}

float distance(const RaySource& rays, std::size_t a, std::size_t b) {
  Ray first, second;
  return distance(rays.peek(a, a + 1, &first)[0], rays.peek(b, b + 1, &second)[0]);
}

/// The first ray that is far from its predecessor and may begin a new row; or `end`. `steps`
/// receives the steps before it.
std::size_t find_jump(const RaySource& rays, std::size_t end, Steps* steps) {
  std::array<Ray, kPiece> room;
  for (std::size_t begin = 0; begin + 1 < end; begin += kPiece - 1) {
    const View<const Ray> some = rays.peek(begin, std::min(begin + kPiece, end), room.data());
    for (std::size_t i = 1; i < some.size; ++i) {
      const float next = distance(some[i - 1], some[i]);
      if (begin + i >= kShortestRow && next > kJump * steps->longest) return begin + i;
      steps->longest = std::max(steps->longest, next);
      steps->sum += next;
    }
  }
  return end;
}

}  // namespace

std::size_t find_picture_row(const RaySource& rays) {
  const std::size_t end = std::min(rays.size() / kRows, kLongestRow) + 1;
  Steps steps;
  const std::size_t row = find_jump(rays, end, &steps);
  if (row == end) return 0;
  const float jump = kJump * steps.longest, down = kStepDown * steps.sum / static_cast<float>(row);
  for (std::size_t n = 1; n < kRows; ++n) {
    if (!(distance(rays, n * row - 1, n * row) > jump)) return 0;
    if (!(distance(rays, (n - 1) * row, n * row) <= down)) return 0;
  }
  return row;
}

}  // namespace raysheaf
