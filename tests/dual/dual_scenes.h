// Extreme triangles and rays, at any scale and position.
#pragma once

#include <cmath>

#include "dual/dual_support.h"
#include "support/random.h"

namespace raysheaf::test {

enum class Shape {
  kSmall,
  kLarge,
  kSlivers,
  kNeedles,
  kCoplanar,
  kDuplicates,
  kLattice,
  kAxisAligned,
  kZeroArea,
  kClosed,
  kManySizes,
  kSingle,
};
inline constexpr Shape kShapes[] = {Shape::kSmall,   Shape::kLarge,       Shape::kSlivers,
                                    Shape::kNeedles, Shape::kCoplanar,    Shape::kDuplicates,
                                    Shape::kLattice, Shape::kAxisAligned, Shape::kZeroArea,
                                    Shape::kClosed,  Shape::kManySizes,   Shape::kSingle};

/// With small integers as coordinates, rays hit edges and corners exactly.
inline Vec3 lattice_point(Random& random) {
  const auto c = [&] { return static_cast<float>(random.below(9)) - 4.0f; };
  return {c(), c(), c()};
}

inline void add_random(Shape shape, Random& random, Soup* soup) {
  const Vec3 p = random.in_box(10);
  switch (shape) {
    case Shape::kSingle:
    case Shape::kLarge:
      return soup->add(p, random.in_box(15), random.in_box(15));
    case Shape::kSlivers: {
      const Vec3 along = random.in_box(9);
      return soup->add(p, p + along, p + along * 0.5f + random.in_box(1e-5f));
    }
    case Shape::kNeedles:
      return soup->add(p, p + random.in_box(8), p + random.in_box(1e-3f));
    case Shape::kCoplanar: {
      const auto at = [&] { return Vec3{p.x + random.between(-3, 3), 1, p.z + random.unit()}; };
      return soup->add(at(), at(), at());
    }
    case Shape::kDuplicates: {
      const Vec3 q{std::floor(p.x * 0.3f), std::floor(p.y * 0.3f), 0};
      return soup->add(q, q + Vec3{2, 0, 0}, q + Vec3{0, 2, 0});
    }
    case Shape::kLattice:
      return soup->add(lattice_point(random), lattice_point(random), lattice_point(random));
    case Shape::kAxisAligned: {
      const Vec3 q = lattice_point(random);
      const Vec3 unit[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      const std::uint32_t axis = random.below(3);
      return soup->add(q, q + unit[axis] * 2, q + unit[(axis + 1) % 3] * 3);
    }
    case Shape::kZeroArea: {
      const Vec3 along = random.in_box(4);
      if (random.below(3) == 0) return soup->add(p, p + along, p + along);
      if (random.below(2) == 0) return soup->add({1, 2, 3}, {3, 6, 9}, {2, 4, 6});
      return soup->add(p, p + along, p + random.in_box(4));
    }
    case Shape::kManySizes: {
      const float size = std::ldexp(1.0f, static_cast<int>(random.below(40)) - 30);
      const Vec3 at = random.below(2) == 0 ? p * size : p;
      return soup->add(at, at + random.in_box(size), at + random.in_box(size));
    }
    default:
      return soup->add(p, p + random.in_box(1.5f), p + random.in_box(1.5f));
  }
}

/// A closed sphere from a grid of longitudes and latitudes.
inline void add_closed(std::uint32_t side, Soup* soup) {
  const auto at = [&](std::uint32_t i, std::uint32_t k) {
    if (i == 0 || i == side) return Vec3{0, i == 0 ? 7.0f : -7.0f, 0};
    const float a = 3.14159265f * static_cast<float>(i) / static_cast<float>(side);
    const float b = 6.28318531f * static_cast<float>(k % side) / static_cast<float>(side);
    return Vec3{7 * std::sin(a) * std::cos(b), 7 * std::cos(a), 7 * std::sin(a) * std::sin(b)};
  };
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t k = 0; k < side; ++k) {
      if (i > 0) soup->add(at(i, k), at(i, k + 1), at(i + 1, k));
      if (i + 1 < side) soup->add(at(i + 1, k), at(i, k + 1), at(i + 1, k + 1));
    }
}

/// Transforms every corner to p * scale + offset.
inline Soup make_soup(Shape shape, std::uint32_t count, Random& random, float scale = 1,
                      Vec3 offset = {}) {
  Soup soup;
  if (shape == Shape::kSingle) count = 1;
  if (shape == Shape::kClosed) {
    add_closed(std::max(3u, static_cast<std::uint32_t>(std::sqrt(count / 2))), &soup);
  } else {
    while (soup.count() < count) add_random(shape, random, &soup);
  }
  for (Vec3& p : soup.positions) p = p * scale + offset;
  return soup;
}

inline Vec3 any_direction(Random& random) {
  const float zero = random.below(2) == 0 ? 0.0f : -0.0f;
  const float one = random.below(2) == 0 ? 1.0f : -1.0f;
  switch (random.below(8)) {
    case 0: {  // along an axis
      const std::uint32_t axis = random.below(3);
      return {axis == 0 ? one : zero, axis == 1 ? one : -zero, axis == 2 ? one : zero};
    }
    case 1: {  // nearly along an axis
      Vec3 d = random.in_box(1e-22f);
      (random.below(2) == 0 ? d.x : d.z) = one;
      return d;
    }
    case 2: {  // in a plane of two axes, and with two or three components of equal size
      const Vec3 d{one, random.below(2) == 0 ? one : -one, random.below(2) == 0 ? zero : one};
      return random.below(2) == 0 ? d : Vec3{d.z, d.x, d.y};
    }
    case 3: {
      const Vec3 d = lattice_point(random);
      return max_component(abs(d)) > 0 ? d : Vec3{0, -0.0f, one};
    }
    default:
      return random.direction();
  }
}

/// Rays from anywhere, from vertices and planes; towards vertices, edges, edge-on, along axes; at
/// the `scale` and `offset` of the soup.
inline Ray any_ray(const Soup& soup, Random& random, float scale = 1, Vec3 offset = {}) {
  const auto point_of = [&](const std::array<Vec3, 3>& t) {
    switch (random.below(4)) {
      case 0:
        return t[random.below(3)];
      case 1:
        return (t[0] + t[1]) * 0.5f;
      case 2:
        return t[0] + (t[2] - t[0]) * random.unit();
      default:
        return t[0] * 0.25f + t[1] * 0.25f + t[2] * 0.5f;
    }
  };
  const auto some = [&] { return soup.corners(random.below(soup.count())); };
  Vec3 o = random.in_box(14) * scale + offset;
  const std::uint32_t from = random.below(8);
  if (from == 0) o = point_of(some());
  if (from == 1) o = lattice_point(random) * scale + offset;
  if (from == 2) o = random.in_box(1e4f) * scale + offset;
  Vec3 d = any_direction(random) * scale;
  const std::uint32_t aim = random.below(5);
  if (aim < 3) d = point_of(some()) - o;
  if (aim == 3) {  // in the plane of a triangle
    const auto t = some();
    const Vec3 e = (t[1] - t[0]) * random.between(-1, 1) + (t[2] - t[0]) * random.between(-1, 1);
    o = point_of(t) - e * random.between(0, 3);
    d = e;
  }
  if (!(max_component(abs(d)) > 0)) d = any_direction(random);
  Ray ray{o, 0, d, kInfinity};
  switch (random.below(10)) {
    case 0:
      ray.t_max = 1;
      break;
    case 1:
      ray.t_min = 0.9f, ray.t_max = 1.1f;
      break;
    case 2:
      ray.t_min = ray.t_max = 1;
      break;
    case 3:
      ray.t_min = 1;
      break;
    case 4:
      ray.t_max = 0;
      break;
    default:
      break;
  }
  return ray;
}

inline std::vector<Ray> any_rays(const Soup& soup, std::size_t count, Random& random,
                                 float scale = 1, Vec3 offset = {}) {
  std::vector<Ray> rays;
  while (rays.size() < count) {
    Ray ray = any_ray(soup, random, scale, offset);
    rays.push_back(ray);
    // Sometimes a bundle of coherent neighbours.
    if (random.below(40) != 0) continue;
    for (int i = 0; i < 30 && rays.size() < count; ++i) {
      const float size = max_component(abs(ray.direction));
      rays.push_back(ray);
      rays.back().direction += random.in_box(0.01f * size);
      if (random.below(2) == 0) rays.back().origin += random.in_box(0.1f * scale);
    }
  }
  for (Ray& ray : rays) {
    if (!is_finite(ray.origin)) ray.origin = offset;
    const float size = max_component(abs(ray.direction));
    if (!is_finite(ray.direction) || !(size > 0)) ray.direction = {1, 0, 0};
  }
  return rays;
}

/// Turns all rays into one quarter around their points at t = 1, which makes long lists of a
/// stream.
inline void turn_into_one_quarter(std::vector<Ray>* rays) {
  for (Ray& ray : *rays) {
    const Vec3 at = ray.origin + ray.direction, m = abs(ray.direction);
    const float largest = max_component(m), least = min_component(m);
    ray.direction = {largest, -least, m.x + m.y + m.z - largest - least};
    ray.origin = at - ray.direction;
    if (!is_finite(ray.origin) || !is_finite(ray.direction)) ray = {{}, 0, {1, -0.0f, 0}};
  }
}

/// Lets all rays start at one point and at one t, and turns them towards their points at t = 1.
inline void start_at(Vec3 from, float t_min, std::vector<Ray>* rays) {
  for (Ray& ray : *rays) {
    const Vec3 towards = ray.origin + ray.direction - from;
    if (is_finite(towards) && max_component(abs(towards)) > 0) ray.direction = towards;
    ray.origin = from;
    ray.t_min = t_min;
    ray.t_max = std::max(ray.t_max, t_min);
  }
}

/// Sets t_min = t_max so that each ray has one hit.
inline void keep_one_hit(const Soup& soup, std::vector<Ray>* rays, Random& random) {
  const HitRows rows = brute_force(soup, *rays);
  for (std::size_t r = 0; r < rays->size(); ++r) {
    if (rows[r].empty()) continue;
    const IndexedHit& hit = rows[r][random.below(static_cast<std::uint32_t>(rows[r].size()))];
    (*rays)[r].t_min = (*rays)[r].t_max = hit.t;
  }
}

/// Rays of one quarter from one point, in `side` rows and columns of coherent neighbours.
inline std::vector<Ray> fan_rays(std::uint32_t side) {
  std::vector<Ray> rays;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const auto at = [&](std::uint32_t i) {
        return (static_cast<float>(i) + 0.5f) / static_cast<float>(side);
      };
      rays.push_back({{0, 0, 0}, 0, {1, at(y), at(x)}, kInfinity});
    }
  return rays;
}

/// Large triangles in front of many small ones, as seen by the rays of `fan_rays`.
inline Soup screened_soup(std::uint32_t large, std::uint32_t small, Random& random) {
  Soup soup;
  for (std::uint32_t i = 0; i < large + small; ++i) {
    const float depth = i < large ? 2.0f : 6.0f, size = i < large ? 1.2f : 0.2f;
    const Vec3 middle =
        Vec3{depth, 0.5f * depth, 0.5f * depth} + random.in_box(0.5f * depth) * Vec3{0.2f, 1, 1};
    soup.add(middle + random.in_box(size), middle + random.in_box(size),
             middle + random.in_box(size));
  }
  return soup;
}

}  // namespace raysheaf::test
