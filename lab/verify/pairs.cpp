#include "lab/verify/pairs.h"

#include <bit>
#include <cmath>
#include <limits>

namespace raysheaf::checks {
namespace {

using Corners = std::array<Vec3, 3>;

RayAndTriangle pair_of(Vec3 origin, Vec3 direction, const Corners& corners) {
  return {{origin, 0, direction, std::numeric_limits<float>::infinity()}, corners};
}

bool is_usable(const RayAndTriangle& pair) {
  const Ray& ray = pair.ray;
  for (const Vec3 p :
       {ray.origin, ray.direction, pair.corners[0], pair.corners[1], pair.corners[2]})
    if (!is_finite(p)) return false;
  return max_component(abs(ray.direction)) > 0;
}

/// Numbers from -most to most whose sums and small multiples are exact.
Vec3 whole_point(std::uint32_t most, Random* random) {
  const auto some = [&] {
    return static_cast<float>(random->below(2 * most + 1)) - static_cast<float>(most);
  };
  const float x = some(), y = some();
  return {x, y, some()};
}

Vec3 whole_direction(std::uint32_t most, Random* random) {
  for (;;) {
    const Vec3 d = whole_point(most, random);
    if (max_component(abs(d)) > 0) return d;
  }
}

/// A corner, a point of an edge, or an inner point: with weights in quarters.
Vec3 quarter_point(const Corners& t, Random* random) {
  const std::uint32_t i = random->below(5), j = random->below(5 - i);
  return (t[0] * static_cast<float>(i) + t[1] * static_cast<float>(j) +
          t[2] * static_cast<float>(4 - i - j)) *
         0.25f;
}

/// A corner, or approximately a point of an edge or an inner point.
Vec3 rounded_point(const Corners& t, Random* random) {
  switch (random->below(3)) {
    case 0:
      return t[random->below(3)];
    case 1: {
      const std::uint32_t i = random->below(3);
      return lerp(t[i], t[(i + 1) % 3], random->unit());
    }
    default:
      return random->in_triangle(t);
  }
}

/// By about an ulp, or by a small fraction.
float nudged(float x, Random* random) {
  if (random->one_in(2)) return std::nextafter(x, random->one_in(2) ? 1e38f : -1e38f);
  const int power = -static_cast<int>(random->below(24));
  return x + std::ldexp(random->one_in(2) ? 1.0f : -1.0f, power);
}

/// Changes one coordinate of the origin or direction, in half of all pairs.
void nudge(Random* random, RayAndTriangle* pair) {
  if (random->one_in(2)) return;
  Vec3& p = random->one_in(2) ? pair->ray.origin : pair->ray.direction;
  float* const coordinates[] = {&p.x, &p.y, &p.z};
  float* const x = coordinates[random->below(3)];
  *x = nudged(*x, random);
}

RayAndTriangle ordinary(Random* random) {
  for (;;) {
    const Corners t{random->in_box(3), random->in_box(3), random->in_box(3)};
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]), origin = random->in_box(10);
    const Vec3 aim = random->in_triangle(t);
    const Vec3 direction = normalized(aim - origin) * random->between(0.1f, 4);
    const float facing = std::fabs(dot(normalized(normal), normalized(direction)));
    if (facing < 0.1f || length(normal) < 1 || length(aim - origin) < 0.5f) continue;
    return pair_of(origin, direction, t);
  }
}

RayAndTriangle aimed(Random* random) {
  const Corners t{random->in_box(3), random->in_box(3), random->in_box(3)};
  const Vec3 origin = random->in_box(10);
  return pair_of(origin, rounded_point(t, random) - origin, t);
}

/// All numbers are exact: the ray reaches a quarter point after `steps` of its direction. The
/// direction is then multiplied by the same number, so that t is a fraction.
RayAndTriangle whole_numbers(Random* random) {
  const std::uint32_t sizes[] = {2, 9, 300, 20000};
  const std::uint32_t most = sizes[random->below(4)];
  const auto corner = [&] { return whole_point(most, random) * 4; };
  const Corners t{corner(), corner(), corner()};
  const Vec3 d = whole_direction(random->one_in(2) ? 3 : most, random);
  const auto steps = static_cast<float>(random->below(8));
  const auto length = static_cast<float>(1 + random->below(7));
  RayAndTriangle pair = pair_of(quarter_point(t, random) - d * steps, d * length, t);
  nudge(random, &pair);
  return pair;
}

/// Small triangles at coordinates of 100 000, in 128ths (the spacing of floats there) or rounded.
RayAndTriangle far_away(Random* random) {
  const Vec3 offset{1e5f, random->one_in(2) ? -1e5f : 0, random->one_in(2) ? 1e5f : 3e4f};
  const bool on_grid = random->one_in(2);
  const auto near = [&] {
    return offset + (on_grid ? whole_point(100, random) * 0.03125f : random->in_box(2));
  };
  const Corners t{near(), near(), near()};
  const Vec3 origin = random->one_in(2) ? near() : random->in_box(10);
  const Vec3 aim = on_grid ? quarter_point(t, random) : rounded_point(t, random);
  RayAndTriangle pair = pair_of(origin, aim - origin, t);
  nudge(random, &pair);
  return pair;
}

/// From a hundred to 10^12 lengths away. Half of the triangles are at 0, where their coordinates
/// and the origin's have no digit in common.
RayAndTriangle from_far(Random* random) {
  const Vec3 offset = random->one_in(2) ? Vec3{} : random->in_box(100);
  const auto near = [&] { return offset + random->in_box(1); };
  const Corners t{near(), near(), near()};
  const Vec3 origin = random->in_box(random->magnitude(2, 12));
  const Vec3 aim = random->one_in(2) ? random->in_triangle(t) : rounded_point(t, random);
  RayAndTriangle pair = pair_of(origin, aim - origin, t);
  nudge(random, &pair);
  return pair;
}

/// Half of a square of 2 000 000, seen from a small height, at its diagonal and its border.
RayAndTriangle ground_plane(Random* random) {
  constexpr float kSide = 1e6f;
  const float y = random->one_in(2) ? 0 : random->between(-2, 2);
  const Corners t{Vec3{-kSide, y, -kSide}, {kSide, y, kSide}, {kSide, y, -kSide}};
  const Vec3 origin = random->in_box(10) + Vec3{0, 12, 0};
  const float side = random->between(-1, 1), x = side * random->magnitude(-2, 6);
  const Vec3 aim = random->one_in(4) ? Vec3{kSide, y, x} : Vec3{x, y, x};
  RayAndTriangle pair = pair_of(origin, aim - origin, t);
  if (random->one_in(2)) pair.corners = {t[1], t[2], t[0]};
  nudge(random, &pair);
  return pair;
}

/// In the triangle's plane exactly, or nearly.
RayAndTriangle edge_on(Random* random) {
  const bool exactly = random->one_in(2);
  const auto point = [&] { return exactly ? whole_point(30, random) : random->in_box(5); };
  const auto weight = [&] {
    return exactly ? static_cast<float>(random->below(9)) - 4 : random->between(-4, 4);
  };
  const Corners t{point(), point(), point()};
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  const Vec3 c = ac * weight(), b = ab * weight();
  const Vec3 origin = t[0] + b + c;
  const Vec3 d = ac * weight();
  Vec3 direction = ab * weight() + d;
  if (random->one_in(3)) direction = t[random->below(3)] - origin;
  RayAndTriangle pair = pair_of(origin, direction, t);
  nudge(random, &pair);
  return pair;
}

/// A triangle whose corner lies on a neighbour's edge, exactly or rounded, and a ray at that edge.
RayAndTriangle t_junction(Random* random) {
  const bool exactly = random->one_in(2);
  const auto point = [&] { return exactly ? whole_point(60, random) * 4 : random->in_box(5); };
  const Vec3 p = point(), q = point(), apex = point();
  const auto at = [&](std::uint32_t quarters) {
    return lerp(p, q, static_cast<float>(quarters) * 0.25f);
  };
  const std::uint32_t middle = 1 + random->below(3);
  const Corners wholes{p, q, apex}, halves{p, at(middle), apex};
  const Vec3 aim = exactly ? at(random->below(5)) : lerp(p, q, random->unit());
  const Vec3 origin = exactly ? whole_point(100, random) : random->in_box(9);
  RayAndTriangle pair = pair_of(origin, aim - origin, random->one_in(2) ? wholes : halves);
  nudge(random, &pair);
  return pair;
}

/// Any finite float, or one near 2^`power`.
float raw_float(int power, bool any, Random* random) {
  for (;;) {
    const auto bits = static_cast<std::uint32_t>(random->bits() >> 32);
    const auto x = std::bit_cast<float>(bits);
    if (any && std::isfinite(x)) return x;
    if (!any) {
      const float one = std::bit_cast<float>((bits & 0x807fffffu) | 0x3f800000u);
      return std::ldexp(one, power + static_cast<int>(random->below(5)) - 2);
    }
  }
}

RayAndTriangle raw_bits(Random* random) {
  const bool any = random->one_in(3);
  const int power = static_cast<int>(random->below(230)) - 140;
  const auto point = [&] {
    const float x = raw_float(power, any, random), y = raw_float(power, any, random);
    return Vec3{x, y, raw_float(power, any, random)};
  };
  const Corners t{point(), point(), point()};
  const Vec3 origin = point();
  const Vec3 direction = any ? point() : rounded_point(t, random) - origin;
  return pair_of(origin, direction, t);
}

/// Other families at other scales: denormals, 1e18, 1e30; the direction has its own scale.
RayAndTriangle scaled(Random* random) {
  RayAndTriangle pair = random->one_in(2) ? whole_numbers(random) : aimed(random);
  const int power = static_cast<int>(random->below(255)) - 150;
  const int spread = static_cast<int>(random->below(41)) - 20;
  const auto by = [](Vec3 p, int n) {
    return Vec3{std::ldexp(p.x, n), std::ldexp(p.y, n), std::ldexp(p.z, n)};
  };
  for (Vec3& p : pair.corners) p = by(p, power);
  pair.ray.origin = by(pair.ray.origin, power);
  pair.ray.direction = by(pair.ray.direction, power + spread);
  return pair;
}

/// Exactly (t = 0), or a rounding in front or behind.
RayAndTriangle starts_on_it(Random* random) {
  const bool exactly = random->one_in(2);
  const auto point = [&] { return exactly ? whole_point(50, random) * 4 : random->in_box(5); };
  const Corners t{point(), point(), point()};
  const Vec3 origin = exactly ? quarter_point(t, random) : rounded_point(t, random);
  RayAndTriangle pair = pair_of(origin, whole_direction(9, random), t);
  nudge(random, &pair);
  if (random->one_in(4)) {  // t that underflows, on either side of 0
    for (Vec3& p : pair.corners) p = p * 0x1p-100f;
    pair.ray.origin = pair.ray.origin * 0x1p-100f;
    pair.ray.direction = pair.ray.direction * 0x1p70f;
  }
  return pair;
}

/// Depths along an axis are differences of floats: often half an ulp from the next.
RayAndTriangle along_an_axis(Random* random) {
  const bool exactly = random->one_in(2);
  const auto point = [&] { return exactly ? whole_point(50, random) * 4 : random->in_box(5); };
  const Corners t{point(), point(), point()};
  const Vec3 at = exactly ? quarter_point(t, random) : rounded_point(t, random);
  const float side = random->between(-1, 1), depth = side * random->magnitude(-3, 5);
  const float zero = random->one_in(2) ? 0.0f : -0.0f, one = random->one_in(2) ? 1.0f : -1.0f;
  switch (random->below(3)) {
    case 0:
      return pair_of({depth, at.y, at.z}, {one, zero, -zero}, t);
    case 1:
      return pair_of({at.x, depth, at.z}, {zero, one, zero}, t);
    default:
      return pair_of({at.x, at.y, depth}, {-zero, zero, one}, t);
  }
}

/// Directions down to the smallest float.
RayAndTriangle short_directions(Random* random) {
  RayAndTriangle pair = random->one_in(2) ? whole_numbers(random) : aimed(random);
  const int power = -static_cast<int>(90 + random->below(60));
  Vec3& d = pair.ray.direction;
  d = {std::ldexp(d.x, power), std::ldexp(d.y, power), std::ldexp(d.z, power)};
  return pair;
}

/// Thin triangles, and triangles without area, which no ray hits.
RayAndTriangle slivers(Random* random) {
  const bool exactly = random->one_in(2);
  const Vec3 a = exactly ? whole_point(30, random) * 4 : random->in_box(5);
  const Vec3 along = exactly ? whole_point(9, random) * 4 : random->in_box(5);
  const auto step = [&] {
    return exactly ? static_cast<float>(random->below(9)) * 0.25f : random->unit();
  };
  Corners t{a, a + along * step(), a + along * step()};
  if (random->one_in(2)) t[random->below(3)] += random->in_box(random->magnitude(-12, -2));
  const Vec3 origin = exactly ? whole_point(100, random) : random->in_box(9);
  RayAndTriangle pair = pair_of(origin, t[random->below(3)] - origin, t);
  if (random->one_in(2)) pair.ray.direction = lerp(t[0], t[1], random->unit()) - origin;
  nudge(random, &pair);
  return pair;
}

template <RayAndTriangle (*kMake)(Random*)>
RayAndTriangle usable(Random* random) {
  for (;;) {
    const RayAndTriangle pair = kMake(random);
    if (is_usable(pair)) return pair;
  }
}

constexpr PairFamily kPairFamilies[] = {
    {"ordinary", usable<ordinary>},
    {"at corners, edges and insides", usable<aimed>},
    {"whole numbers", usable<whole_numbers>},
    {"at coordinates of 100 000", usable<far_away>},
    {"from far", usable<from_far>},
    {"a ground plane", usable<ground_plane>},
    {"edge-on", usable<edge_on>},
    {"T-junctions", usable<t_junction>},
    {"raw bits", usable<raw_bits>},
    {"all scales", usable<scaled>},
    {"origins on the plane", usable<starts_on_it>},
    {"along an axis", usable<along_an_axis>},
    {"short directions", usable<short_directions>},
    {"slivers", usable<slivers>},
};

}  // namespace

std::span<const PairFamily> pair_families() {
  return kPairFamilies;
}

}  // namespace raysheaf::checks
