#include "lab/verify/families.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lab/verify/whole_meshes.h"

namespace raysheaf::checks {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();
constexpr float kFarthestPower = 12;  ///< of distances, in scales

float* coordinate(Vec3* p, std::uint32_t axis) {
  return axis == 0 ? &p->x : axis == 1 ? &p->y : &p->z;
}

Vec3 along(std::uint32_t axis, float length) {
  Vec3 p;
  *coordinate(&p, axis) = length;
  return p;
}

/// From -10^12 to 10^12 scales.
float some_distance(const Soup& soup, Random* random) {
  const float distance = soup.scale * random->magnitude(0, kFarthestPower);
  return random->one_in(2) ? distance : -distance;
}

Vec3 target_of(const Soup& soup, Random* random) {
  if (random->one_in(8)) return soup.offset + random->in_box(15) * soup.scale;
  return point_of(soup.some_triangle(random), random);
}

Ray legal(Ray ray, Random* random) {
  if (!is_finite(ray.origin)) ray.origin = {};
  if (!is_legal(ray)) ray.direction = random->direction();
  return ray;
}

/// Other coordinates than the far one are near the target, so that the direction aims at it
/// however far the origin is.
Ray far_ray(const Soup& soup, Random* random) {
  const Vec3 corner = soup.some_triangle(random)[random->below(3)];
  const Vec3 target = random->one_in(2) ? corner : target_of(soup, random);
  const std::uint32_t axis = random->below(3);
  const float distance = some_distance(soup, random);
  Vec3 origin = target + along(axis, distance);
  if (!random->one_in(3)) origin += random->in_box(5) * soup.scale;
  if (random->one_in(4)) *coordinate(&origin, (axis + 1) % 3) += some_distance(soup, random);
  Ray ray{origin, 0, target - origin, kEndless};
  if (random->one_in(3)) ray.direction = along(axis, distance > 0 ? -1.0f : 1.0f);
  give_interval(random, &ray);
  return legal(ray, random);
}

std::vector<Ray> far_rays(const Soup& soup, std::size_t count, Random* random) {
  std::vector<Ray> rays;
  while (rays.size() < count) rays.push_back(far_ray(soup, random));
  return rays;
}

/// Sixteen far rays among thousands of near ones.
std::vector<Ray> mixed_rays(const Soup& soup, std::size_t count, Random* random) {
  std::vector<Ray> rays = make_rays(soup, count, random);
  for (std::size_t i = 0; i < 1 + count / 256; ++i)
    rays[random->below(static_cast<std::uint32_t>(count))] = far_ray(soup, random);
  return rays;
}

/// Rows of an image of the soup's middle.
std::vector<Ray> camera_rays(const Soup& soup, std::size_t count, Random* random) {
  const std::uint32_t axis = random->below(3);
  const float distance = some_distance(soup, random) * 10;
  const Vec3 off_axis = random->in_box(9) * soup.scale;
  const Vec3 eye = soup.offset + along(axis, distance) + off_axis;
  const auto width = static_cast<std::size_t>(std::sqrt(static_cast<float>(count))) + 1;
  const float step = 24 * soup.scale / static_cast<float>(width);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 target = soup.offset;
    const std::size_t column = i % width, row = i / width;
    *coordinate(&target, (axis + 1) % 3) += (static_cast<float>(column) + 0.5f) * step;
    *coordinate(&target, (axis + 2) % 3) += (static_cast<float>(row) + 0.5f) * step;
    const Vec3 corner =
        along((axis + 1) % 3, 12 * soup.scale) + along((axis + 2) % 3, 12 * soup.scale);
    rays.push_back(legal({eye, 0, target - corner - eye, kEndless}, random));
  }
  return rays;
}

/// Parallel, from a plane that is nearby or far away.
std::vector<Ray> sun_rays(const Soup& soup, std::size_t count, Random* random) {
  const std::uint32_t axis = random->below(3);
  const Vec3 away = along(axis, some_distance(soup, random));
  Vec3 direction = -away;
  if (random->one_in(2)) direction += random->in_box(1) * max_component(abs(away));
  std::vector<Ray> rays;
  while (rays.size() < count)
    rays.push_back(legal({target_of(soup, random) - direction, 0, direction, kEndless}, random));
  return rays;
}

/// From points of triangles to a lamp.
std::vector<Ray> shadow_rays(const Soup& soup, std::size_t count, Random* random) {
  Vec3 lamp = soup.offset + random->in_box(20) * soup.scale;
  if (random->one_in(2)) lamp += along(random->below(3), some_distance(soup, random));
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Vec3 from = target_of(soup, random);
    Ray ray{from, random->one_in(2) ? 0 : 1e-4f, lamp - from, 1};
    if (random->one_in(2)) ray = {lamp, 0, from - lamp, random->one_in(2) ? 1 : 0.9999f};
    rays.push_back(legal(ray, random));
  }
  return rays;
}

/// Numbers at the ends of what floats can be.
std::vector<Ray> special_rays(const Soup& soup, std::size_t count, Random* random) {
  constexpr float kLeast = std::numeric_limits<float>::denorm_min();
  constexpr float kNumbers[] = {
      0,      -0.0f,  kLeast, -kLeast, 1e-30f, std::numeric_limits<float>::min(),
      1e-20f, -1e20f, 1e30f,  -3e38f,  1,      -1};
  const auto some = [&] { return kNumbers[random->below(std::size(kNumbers))]; };
  std::vector<Ray> rays = make_rays(soup, count, random);
  for (Ray& ray : rays) {
    const std::uint32_t what = random->below(5), axis = random->below(3);
    if (what == 0) *coordinate(&ray.origin, axis) = some();
    if (what == 1) *coordinate(&ray.direction, axis) = some();
    if (what == 2) ray.direction = ray.direction * random->magnitude(-25, 25);
    if (what == 3) ray.t_max = std::max(ray.t_min, std::fabs(some()));
    if (what == 4) ray.t_min = std::min(ray.t_max, std::fabs(some()));
    ray = legal(ray, random);
  }
  return rays;
}

/// In whole numbers of steps from a corner, mostly exactly: such rays graze boxes.
std::vector<Ray> far_whole_rays(const Soup& soup, std::size_t count, Random* random) {
  const auto whole = [&] { return static_cast<float>(random->below(7)) - 3; };
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Vec3 corner = soup.some_triangle(random)[random->below(3)];
    const float x = whole(), y = whole();
    const Vec3 step = Vec3{x, y, whole()} * soup.scale;
    const float steps = std::ldexp(1.0f, static_cast<int>(random->below(40)));
    Ray ray{corner - step * steps, 0, step * (random->one_in(2) ? 1 : steps), kEndless};
    give_interval(random, &ray);
    rays.push_back(legal(ray, random));
  }
  return rays;
}

std::vector<Ray> whole_rays(const Soup& soup, std::size_t count, Random* random) {
  const bool one_origin = random->one_in(3);
  return make_whole_rays(soup, count, one_origin, random);
}

constexpr RayFamily kFamilies[] = {{"any", make_rays},
                                   {"one origin", make_fan},
                                   {"far", far_rays},
                                   {"mixed", mixed_rays},
                                   {"camera", camera_rays},
                                   {"parallel", sun_rays},
                                   {"shadow", shadow_rays},
                                   {"special", special_rays},
                                   {"whole-number", whole_rays, true},
                                   {"far whole-number", far_whole_rays, true}};

}  // namespace

std::span<const RayFamily> ray_families() {
  return kFamilies;
}

std::vector<Ray> cut_at(std::vector<Ray> rays, std::span<const float> t, Random* random) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(t[i] < kEndless)) continue;
    Ray& ray = rays[i];
    const std::uint32_t what = random->below(8);
    const float before = std::max(0.0f, std::nextafter(t[i], -kEndless));
    if (what == 0) ray.t_min = std::nextafter(t[i], kEndless);
    if (what == 1) ray.t_max = before;
    if (what >= 2 && what <= 5) ray.t_min = t[i];
    if (what >= 3 && what <= 6) ray.t_max = t[i];
    ray.t_max = std::max(ray.t_min, ray.t_max);
  }
  return rays;
}

std::vector<std::array<double, 3>> make_points(const Soup& soup, std::size_t count,
                                               Random* random) {
  std::vector<std::array<double, 3>> points;
  const float far = random->one_in(2) ? some_distance(soup, random) : 0;
  const std::uint32_t axis = random->below(3);
  while (points.size() < count) {
    Vec3 p = point_of(soup.some_triangle(random), random);
    const std::uint32_t kind = random->below(8);
    if (kind <= 1) p = soup.offset + random->in_box(14) * soup.scale;
    if (kind == 2) p += random->in_box(1) * (soup.scale * random->magnitude(-7, 1));
    if (kind == 3) p += along(random->below(3), some_distance(soup, random));
    if (kind == 4) p += random->direction() * some_distance(soup, random);
    if (kind == 5) p = soup.offset + random->in_box(8) * soup.scale + along(axis, far);
    p = clamped(p);
    std::array<double, 3> point{p.x, p.y, p.z};
    if (kind == 6)  // no floats
      for (double& x : point) x += double{soup.scale} * 1e-10 * (double{random->unit()} - 0.5);
    points.push_back(point);
  }
  return points;
}

}  // namespace raysheaf::checks
