#include "bundle_lines.h"

#include <cmath>

#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr std::size_t kMostRays = 64;
constexpr int kCircle = 32, kGenerators = 12;

class Lines {
 public:
  Lines(float reach, std::vector<WorldLine>* out) : reach_(reach), out_(*out) {}

  void ray(const Ray& ray, bool asked) {
    const float end = std::fmin(ray.t_max, reach_ / std::fmax(length(ray.direction), 1e-30f));
    add(ray.origin + ray.direction * std::fmin(ray.t_min, end), ray.origin + ray.direction * end,
        asked ? WorldLine::Kind::kAskedRay : WorldLine::Kind::kRay);
  }

  void volume(const BundleVolume& volume, std::uint32_t level) {
    level_ = level;
    if (volume.has_hull) hull(volume);
    if (volume.has_cone) cone(volume);
  }

 private:
  static Vec3 corner(const Box& box, unsigned bits) {
    return {(bits & 1) != 0 ? box.max.x : box.min.x, (bits & 2) != 0 ? box.max.y : box.min.y,
            (bits & 4) != 0 ? box.max.z : box.min.z};
  }

  void hull(const BundleVolume& volume) {
    for (unsigned bits = 0; bits < 8; ++bits) {
      for (unsigned axis = 1; axis < 8; axis *= 2) {
        if ((bits & axis) != 0) continue;
        clipped(corner(volume.origins, bits), corner(volume.origins, bits | axis), volume.within);
        clipped(corner(volume.ends, bits), corner(volume.ends, bits | axis), volume.within);
      }
      clipped(corner(volume.origins, bits), corner(volume.ends, bits), volume.within);
    }
  }

  /// Clips a line to a box.
  void clipped(Vec3 from, Vec3 to, const Box& box) {
    float lo = 0, hi = 1;
    const auto clip = [&](float a, float b, float low, float high) {
      const float d = b - a;
      if (d == 0) {
        if (a < low || a > high) hi = -1;
        return;
      }
      const float near = ((d > 0 ? low : high) - a) / d, far = ((d > 0 ? high : low) - a) / d;
      lo = std::fmax(lo, near);
      hi = std::fmin(hi, far);
    };
    clip(from.x, to.x, box.min.x, box.max.x);
    clip(from.y, to.y, box.min.y, box.max.y);
    clip(from.z, to.z, box.min.z, box.max.z);
    if (lo < hi) add(mix(from, to, lo), mix(from, to, hi), WorldLine::Kind::kHull);
  }

  void circle(Vec3 center, Vec3 u, Vec3 v) {
    Vec3 last = center + u;
    for (int i = 1; i <= kCircle; ++i) {
      const float angle = 2 * kPi * static_cast<float>(i) / kCircle;
      const Vec3 next = center + u * std::cos(angle) + v * std::sin(angle);
      add(last, next, WorldLine::Kind::kCone);
      last = next;
    }
  }

  void cone(const BundleVolume& volume) {
    const Vec3 axis = normalized(volume.axis);
    const Vec3 aside = std::fabs(axis.x) < 0.6f ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = normalized(cross(axis, aside)), v = cross(axis, u);
    const float r = volume.radius;
    circle(volume.center, u * r, v * r);
    circle(volume.center, u * r, axis * r);
    circle(volume.center, v * r, axis * r);
    if (volume.sin_angle > 1) return;  // all directions: draw only the sphere
    const float s = volume.sin_angle, c = std::sqrt(std::fmax(0.0f, 1 - s * s));
    const float far = std::fmin(volume.reach, reach_);
    for (int i = 0; i < kGenerators; ++i) {
      const float angle = 2 * kPi * static_cast<float>(i) / kGenerators;
      const Vec3 out = u * std::cos(angle) + v * std::sin(angle);
      // Tangent to the sphere, where it is farthest from the generator's line.
      const Vec3 start = volume.center + (out * c - axis * s) * r;
      add(start, start + (axis * c + out * s) * far, WorldLine::Kind::kCone);
    }
    const float wide = r * c + s * far;
    circle(volume.center + axis * (c * far - s * r), u * wide, v * wide);
  }

  void add(Vec3 from, Vec3 to, WorldLine::Kind kind) {
    if (is_finite(from) && is_finite(to) && length(to - from) > 0)
      out_.push_back({from, to, kind, level_});
  }

  const float reach_;
  std::vector<WorldLine>& out_;
  std::uint32_t level_ = 0;
};

}  // namespace

std::vector<WorldLine> bundle_lines(const RayBundle& bundle, float reach) {
  std::vector<WorldLine> all;
  Lines lines(reach, &all);
  for (std::size_t i = bundle.volumes.size(); i-- > 0;)
    lines.volume(bundle.volumes[i], static_cast<std::uint32_t>(i));
  const std::size_t step = (bundle.rays.size() + kMostRays - 1) / kMostRays;
  for (std::size_t i = 0; i < bundle.rays.size(); i += step)
    if (i != bundle.ray) lines.ray(bundle.rays[i], false);
  if (bundle.ray < bundle.rays.size()) lines.ray(bundle.rays[bundle.ray], true);
  return all;
}

}  // namespace raysheaf::viewer
