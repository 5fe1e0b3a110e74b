#include "lab/verify/soup.h"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace raysheaf::checks {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kFarthest = 5e17f;  ///< of all coordinates: scenes accept 1e18

using CornerList = std::vector<Vec3>;

void add(Vec3 a, Vec3 b, Vec3 c, CornerList* out) {
  out->insert(out->end(), {a, b, c});
}

/// Small integers: rays hit edges and corners exactly.
Vec3 lattice_point(Random* random) {
  const float x = static_cast<float>(random->below(9)) - 4;
  const float y = static_cast<float>(random->below(9)) - 4;
  return {x, y, static_cast<float>(random->below(9)) - 4};
}

void add_small(Random* r, CornerList* out) {
  const Vec3 p = r->in_box(10), c = p + r->in_box(1), b = p + r->in_box(1);
  add(p, b, c, out);
}
void add_large(Random* r, CornerList* out) {
  const Vec3 c = r->in_box(15), b = r->in_box(15), a = r->in_box(15);
  add(a, b, c, out);
}
void add_needle(Random* r, CornerList* out) {
  const Vec3 p = r->in_box(10), c = p + r->in_box(1e-3f), b = p + r->in_box(8);
  add(p, b, c, out);
}
void add_sliver(Random* r, CornerList* out) {
  const Vec3 p = r->in_box(10), along = r->in_box(9);
  add(p, p + along, p + along * 0.5f + r->in_box(1e-5f), out);
}
void add_coplanar(Random* r, CornerList* out) {
  const Vec3 p = r->in_box(10);
  const auto near = [&] { return Vec3{p.x + r->between(-3, 3), 1, p.z + r->between(-3, 3)}; };
  const Vec3 c = near(), b = near();
  add({p.x, 1, p.z}, b, c, out);
}
void add_duplicate(Random* r, CornerList* out) {
  const Vec3 p{std::floor(r->between(-4, 4)), std::floor(r->between(-4, 4)), 0};
  add(p, p + Vec3{2, 0, 0}, p + Vec3{0, 2, 0}, out);
}
void add_lattice(Random* r, CornerList* out) {
  const Vec3 c = lattice_point(r), b = lattice_point(r), a = lattice_point(r);
  add(a, b, c, out);
}
void add_without_area(Random* r, CornerList* out) {
  const Vec3 p = lattice_point(r), q = lattice_point(r);
  if (r->one_in(3)) return add_small(r, out);
  if (r->one_in(2)) return add(p, q, q, out);
  add(p, p + q, p + q * 0.5f, out);
}
void add_any_size(Random* r, CornerList* out) {
  const float size = r->magnitude(-6, 1);
  const Vec3 p = r->in_box(10), c = p + r->in_box(size), b = p + r->in_box(size);
  add(p, b, c, out);
}
/// Two triangles of a wavy sheet: neighbours share edges and corners.
void add_sheet_cell(Random* r, CornerList* out) {
  const auto at = [](float x, float z) {
    return Vec3{x, std::sin(x * 0.7f) * std::cos(z * 0.9f), z};
  };
  const float x = static_cast<float>(r->below(12)) - 6, z = static_cast<float>(r->below(12)) - 6;
  add(at(x, z), at(x + 1, z), at(x, z + 1), out);
  add(at(x + 1, z), at(x + 1, z + 1), at(x, z + 1), out);
}

struct Kind {
  const char* name;
  void (*add)(Random*, CornerList*);
};
constexpr Kind kKinds[] = {{"small triangles", add_small},
                           {"large triangles", add_large},
                           {"needles", add_needle},
                           {"slivers", add_sliver},
                           {"coplanar triangles", add_coplanar},
                           {"duplicates", add_duplicate},
                           {"lattice triangles", add_lattice},
                           {"triangles, many without area", add_without_area},
                           {"triangles of all sizes", add_any_size},
                           {"cells of a sheet", add_sheet_cell}};

}  // namespace

Vec3 clamped(Vec3 p) {
  return {clamp(p.x, -kFarthest, kFarthest), clamp(p.y, -kFarthest, kFarthest),
          clamp(p.z, -kFarthest, kFarthest)};
}

Vec3 point_of(const std::array<Vec3, 3>& t, Random* random) {
  switch (random->below(4)) {
    case 0:
      return t[random->below(3)];
    case 1:
      return t[0] * 0.5f + t[1] * 0.5f;
    case 2:
      return lerp(t[1], t[2], random->unit());
    default:
      return random->in_triangle(t);
  }
}

namespace {

Vec3 some_direction(Random* random) {
  const float zero = random->one_in(2) ? 0.0f : -0.0f, one = random->one_in(2) ? 1.0f : -1.0f;
  switch (random->below(6)) {
    case 0: {  // along an axis
      const std::uint32_t axis = random->below(3);
      return {axis == 0 ? one : zero, axis == 1 ? one : -zero, axis == 2 ? one : zero};
    }
    case 1: {  // nearly along an axis
      Vec3 d = random->in_box(1e-12f);
      (random->one_in(2) ? d.x : d.z) = one;
      return d;
    }
    case 2: {  // two or three components are equally long
      const Vec3 d{one, random->one_in(2) ? one : -one, random->one_in(2) ? zero : one};
      return random->one_in(2) ? d : Vec3{d.z, d.x, d.y};
    }
    default:
      return random->direction();
  }
}

}  // namespace

void give_interval(Random* random, Ray* ray) {
  switch (random->below(10)) {
    case 0:
      ray->t_max = 1;
      break;
    case 1:
      ray->t_min = 0.9f, ray->t_max = 1.1f;
      break;
    case 2:
      ray->t_min = ray->t_max = 1;
      break;
    case 3:
      ray->t_min = 1;
      break;
    case 4:
      ray->t_max = 0;
      break;
    default:
      break;
  }
}

bool is_legal(const Ray& ray) {
  return is_finite(ray.origin) && is_finite(ray.direction) && max_component(abs(ray.direction)) > 0;
}

namespace {

Vec3 some_origin(const Soup& soup, Random* random) {
  switch (random->below(8)) {
    case 0:
      return point_of(soup.some_triangle(random), random);
    case 1:
      return clamped(lattice_point(random) * soup.scale + soup.offset);
    case 2:
      return clamped(random->in_box(1e4f) * soup.scale + soup.offset);
    default:
      return clamped(random->in_box(14) * soup.scale + soup.offset);
  }
}

Ray some_ray(const Soup& soup, Random* random) {
  Ray ray{some_origin(soup, random), 0, some_direction(random) * soup.scale, kInfinity};
  const std::uint32_t aim = random->below(5);
  if (aim < 3) ray.direction = point_of(soup.some_triangle(random), random) - ray.origin;
  if (aim == 3) {  // in the plane of a triangle
    const std::array<Vec3, 3> t = soup.some_triangle(random);
    const Vec3 along_ac = (t[2] - t[0]) * random->between(-1, 1);
    const Vec3 along = (t[1] - t[0]) * random->between(-1, 1) + along_ac;
    const Vec3 back = along * random->between(0, 3);
    ray.origin = clamped(point_of(t, random) - back);
    ray.direction = along;
  }
  give_interval(random, &ray);
  if (!is_legal(ray)) ray.direction = some_direction(random);
  return ray;
}

}  // namespace

std::uint32_t Soup::triangle_count() const {
  std::size_t corners = 0;
  for (const std::vector<Vec3>& mesh : meshes) corners += mesh.size();
  return static_cast<std::uint32_t>(corners / 3);
}

std::array<Vec3, 3> Soup::some_triangle(Random* random) const {
  const std::vector<Vec3>& mesh = meshes[random->below(static_cast<std::uint32_t>(meshes.size()))];
  const std::size_t first = 3 * random->below(static_cast<std::uint32_t>(mesh.size() / 3));
  return {mesh[first], mesh[first + 1], mesh[first + 2]};
}

std::string Soup::text() const {
  char scale_text[32];
  std::snprintf(scale_text, sizeof scale_text, "%.3g", static_cast<double>(scale));
  const bool away = max_component(abs(offset)) > 0;
  return std::to_string(triangle_count()) + " " + kind + ", scale " + scale_text +
         (away ? ", far from the origin" : "");
}

void Soup::add_to(Scene* scene) const {
  for (const std::vector<Vec3>& mesh : meshes) scene->add_soup(mesh);
  scene->commit();
}

SceneDescription Soup::description() const {
  SceneDescription scene;
  for (const std::vector<Vec3>& corners : meshes) {
    Mesh mesh;
    mesh.positions = corners;
    for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3)
      mesh.triangles.push_back({i, i + 1, i + 2});
    Instance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back(instance);
  }
  return scene;
}

Soup make_soup(std::uint32_t most_triangles, const Reach& reach, Random* random) {
  // Half of all soups have scales that are usual for scenes.
  const float lo = random->one_in(2) ? 1e-3f : reach.smallest;
  const float hi = lo == 1e-3f ? 1e3f : reach.largest;
  const float scale = random->magnitude(std::log10(lo), std::log10(hi));
  Vec3 offset;
  if (random->one_in(3)) {
    const float distance = scale * random->magnitude(0, std::log10(reach.farthest));
    offset = random->direction() * distance;
  }
  return make_soup_at(most_triangles, scale, offset, random);
}

Soup make_soup_at(std::uint32_t most_triangles, float scale, Vec3 offset, Random* random) {
  Soup soup;
  const Kind& kind = kKinds[random->below(std::size(kKinds))];
  soup.kind = kind.name;
  soup.scale = scale;
  soup.offset = offset;
  CornerList corners;
  const std::uint32_t wanted =
      1 + random->below(random->one_in(4) ? most_triangles : most_triangles / 8 + 1);
  while (corners.size() < std::size_t{3} * wanted) kind.add(random, &corners);
  for (Vec3& p : corners) p = clamped(p * soup.scale + soup.offset);
  for (std::size_t first = 0; first < corners.size();) {
    const std::size_t count =
        std::min<std::size_t>(3 * (1 + random->below(100)), corners.size() - first);
    const auto begin = corners.begin() + static_cast<std::ptrdiff_t>(first);
    soup.meshes.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(count));
    first += count;
  }
  return soup;
}

std::vector<Ray> make_rays(const Soup& soup, std::size_t count, Random* random) {
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Ray ray = some_ray(soup, random);
    rays.push_back(ray);
    if (!random->one_in(40)) continue;
    const float size = max_component(abs(ray.direction));
    for (int i = 0; i < 30 && rays.size() < count; ++i) {  // a group of neighbouring rays
      Ray neighbour = ray;
      neighbour.direction += random->in_box(0.01f * size);
      if (random->one_in(2))
        neighbour.origin = clamped(ray.origin + random->in_box(0.1f * soup.scale));
      rays.push_back(is_legal(neighbour) ? neighbour : ray);
    }
  }
  return rays;
}

std::vector<Ray> make_fan(const Soup& soup, std::size_t count, Random* random) {
  std::vector<Ray> rays;
  const Vec3 origin = some_origin(soup, random);
  while (rays.size() < count) {
    Ray ray = some_ray(soup, random);
    if (random->one_in(2)) ray.direction = point_of(soup.some_triangle(random), random) - origin;
    ray.origin = origin;
    if (is_legal(ray)) rays.push_back(ray);
  }
  return rays;
}

}  // namespace raysheaf::checks
