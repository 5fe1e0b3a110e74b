#include "scenes/outline.h"

#include <array>

#include "base/vec.h"
#include "scenes/builder.h"

namespace raysheaf::builtin {
namespace {

Vec2 unit(float x, float y) {
  const Vec3 n = normalized({x, y, 0});
  return {n.x, n.y};
}

}  // namespace

Vec2 blended_normal(Vec2 own, Vec2 neighbour) {
  constexpr float kCosCrease = 0.766f;
  if (own.x * neighbour.x + own.y * neighbour.y < kCosCrease) return own;
  return unit(own.x + neighbour.x, own.y + neighbour.y);
}

std::vector<LineNormals> line_normals(std::span<const Vec2> points, bool closed) {
  const std::size_t n = points.size(), count = closed ? n : n - 1;
  std::vector<Vec2> flat;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 a = points[i], b = points[(i + 1) % n];
    flat.push_back(unit(b.y - a.y, a.x - b.x));
  }
  std::vector<LineNormals> result;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 last = closed || i > 0 ? flat[(i + count - 1) % count] : flat[i];
    const Vec2 next = closed || i + 1 < count ? flat[(i + 1) % count] : flat[i];
    result.push_back({blended_normal(flat[i], last), blended_normal(flat[i], next)});
  }
  return result;
}

std::vector<float> distances(std::span<const Vec2> points, bool closed) {
  std::vector<float> result{0};
  for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i) {
    const Vec2 a = points[i], b = points[(i + 1) % points.size()];
    result.push_back(result.back() + length({b.x - a.x, b.y - a.y, 0}));
  }
  return result;
}

std::vector<Vec2> circle(float radius, int sides) {
  std::vector<Vec2> result;
  for (int i = 0; i < sides; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(sides);
    result.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return result;
}

std::vector<Vec2> rounded_rectangle(float width, float height, float radius, int steps) {
  const float x = width / 2 - radius, y = height / 2 - radius;
  const std::array<Vec2, 4> corners = {{{x, y}, {-x, y}, {-x, -y}, {x, -y}}};
  std::vector<Vec2> result;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const float turn = static_cast<float>(i) + static_cast<float>(j) / static_cast<float>(steps);
      const float angle = radians(90) * turn;
      const Vec2 c = corners[static_cast<std::size_t>(i)];
      result.push_back({c.x + radius * std::cos(angle), c.y + radius * std::sin(angle)});
    }
  }
  return result;
}

}  // namespace raysheaf::builtin
