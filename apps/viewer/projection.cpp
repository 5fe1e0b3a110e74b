#include "projection.h"

#include <cmath>

#include "vec.h"

namespace raysheaf::viewer {
namespace {

/// The camera's axes with unit length, and half of the visible size at depth 1 (or at any depth, if
/// orthographic).
struct Frame {
  Vec3 right, up, back, eye;
  float half_width, half_height;
  bool parallel;

  Frame(const Camera& camera, float aspect)
      : right(normalized(column(camera.to_world, 0))),
        up(normalized(column(camera.to_world, 1))),
        back(normalized(column(camera.to_world, 2))),
        eye(column(camera.to_world, 3)),
        half_width(0),
        half_height(camera.orthographic ? camera.y_mag : std::tan(camera.y_fov / 2)),
        parallel(camera.orthographic) {
    if (aspect < camera.aspect_ratio) half_height *= camera.aspect_ratio / aspect;
    half_width = half_height * aspect;
  }
  [[nodiscard]] Vec3 seen(Vec3 p) const {
    const Vec3 d = p - eye;
    return {dot(d, right), dot(d, up), -dot(d, back)};
  }
};

}  // namespace

std::array<float, 16> view_projection(const Camera& camera, float aspect, float near, float far) {
  const Frame f(camera, aspect);
  const Vec3 rows[3] = {f.right * (1 / f.half_width), f.up * (1 / f.half_height), f.back * -1.0f};
  // Depth d ahead: clip z = a d + b, clip w = d, or 1 in parallel.
  const float a = f.parallel ? 2 / (far - near) : (far + near) / (far - near);
  const float b = f.parallel ? -(far + near) / (far - near) : -2 * far * near / (far - near);
  std::array<float, 16> m{};
  const auto put = [&m](std::size_t row, Vec3 v, float last) {
    m[row] = v.x;
    m[4 + row] = v.y;
    m[8 + row] = v.z;
    m[12 + row] = last;
  };
  put(0, rows[0], -dot(rows[0], f.eye));
  put(1, rows[1], -dot(rows[1], f.eye));
  put(2, rows[2] * a, -dot(rows[2], f.eye) * a + b);
  if (f.parallel) {
    put(3, {0, 0, 0}, 1);
  } else {
    put(3, rows[2], -dot(rows[2], f.eye));
  }
  return m;
}

bool may_show(const std::array<float, 16>& transform, const Box& box) {
  const Vec3 center = mix(box.min, box.max, 0.5f), half = (box.max - box.min) * 0.5f;
  const auto row = [&transform](std::size_t r, float sign, std::size_t k) {
    return transform[4 * k + 3] + sign * transform[4 * k + r];
  };
  for (std::size_t r = 0; r < 3; ++r) {
    for (const float sign : {-1.0f, 1.0f}) {
      // The box's largest value of w +- x, y or z: below 0, all of it is outside this side.
      const float x = row(r, sign, 0), y = row(r, sign, 1), z = row(r, sign, 2);
      const float middle = x * center.x + y * center.y + z * center.z + row(r, sign, 3);
      const float reach = std::fabs(x) * half.x + std::fabs(y) * half.y + std::fabs(z) * half.z;
      if (middle + reach < -1e-4f * (reach + std::fabs(row(r, sign, 3)))) return false;
    }
  }
  return true;
}

std::array<Vec3, 4> picture_corners(const Camera& camera, float aspect, float depth) {
  return {unproject(camera, aspect, {0, 0}, depth), unproject(camera, aspect, {1, 0}, depth),
          unproject(camera, aspect, {0, 1}, depth), unproject(camera, aspect, {1, 1}, depth)};
}

Vec3 unproject(const Camera& camera, float aspect, Spot spot, float depth) {
  const Frame f(camera, aspect);
  const float reach = f.parallel ? 1 : depth;
  return f.eye - f.back * depth + f.right * ((2 * spot.x - 1) * f.half_width * reach) +
         f.up * ((1 - 2 * spot.y) * f.half_height * reach);
}

std::optional<SpotPair> project(const Camera& camera, float aspect, Vec3 from, Vec3 to) {
  const Frame f(camera, aspect);
  Vec3 a = f.seen(from), b = f.seen(to);
  if (!f.parallel) {
    // Far enough ahead that the divisor stays away from 0, whatever the scene's scale.
    const float least = 1e-4f * std::fmax(length(a), length(b)) + 1e-30f;
    if (a.z < least && b.z < least) return std::nullopt;
    if (a.z < least) a = mix(a, b, (least - a.z) / (b.z - a.z));
    if (b.z < least) b = mix(b, a, (least - b.z) / (a.z - b.z));
  }
  const auto spot = [&f](Vec3 p) {
    const float w = f.parallel ? 1 : p.z;
    return Spot{0.5f + 0.5f * p.x / (w * f.half_width), 0.5f - 0.5f * p.y / (w * f.half_height)};
  };
  return SpotPair{spot(a), spot(b)};
}

DepthRange depth_range(const Camera& camera, const Box& bounds) {
  const Frame f(camera, 1);
  const Vec3 center = mix(bounds.min, bounds.max, 0.5f);
  const float radius = 0.5f * length(bounds.max - bounds.min);
  const float ahead = f.seen(center).z;
  const float far = std::fmax(ahead + radius, 1e-3f * radius + 1e-20f) * 1.01f;
  // A thousandth keeps the resolution of 24 bits at the far end.
  const float near = std::fmax(camera.z_near, f.parallel ? ahead - radius : ahead - 1.01f * radius);
  return {std::fmin(std::fmax(near, 1e-3f * far), 0.5f * far), far};
}

GroundGrid ground_grid(const Box& bounds, Vec3 up) {
  const Vec3 low = up.x + up.y + up.z > 0 ? bounds.min : bounds.max;
  Vec3 center = mix(bounds.min, bounds.max, 0.5f);
  center = center + up * dot(low - center, up);
  const float size = length(bounds.max - bounds.min);
  const float cell = std::isnormal(size) ? std::pow(10.0f, std::floor(std::log10(size)) - 1) : 1.0f;
  const Vec3 right = std::fabs(up.x) > 0.5f ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  return {center, right, cross(up, right), cell};
}

}  // namespace raysheaf::viewer
