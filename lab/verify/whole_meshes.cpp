#include "lab/verify/whole_meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raysheaf::checks {
namespace {

constexpr float kUnit = 4;  ///< of coordinates: quarter points are integers

using Face = std::array<Vec3, 3>;
using Faces = std::vector<Face>;

float whole(std::uint32_t most, Random* random) {
  return static_cast<float>(random->below(2 * most + 1)) - static_cast<float>(most);
}

Vec3 whole_vertex(std::uint32_t most, Random* random) {
  const float x = whole(most, random), y = whole(most, random);
  return {x, y, whole(most, random)};
}

/// Two triangles, cut along either diagonal.
void add_cell(const std::array<Vec3, 4>& p, Random* random, Faces* out) {
  if (random->one_in(2)) {
    out->push_back({p[0], p[1], p[2]});
    out->push_back({p[0], p[2], p[3]});
  } else {
    out->push_back({p[0], p[1], p[3]});
    out->push_back({p[1], p[2], p[3]});
  }
}

std::uint32_t side_of(std::uint32_t triangles) {
  return std::max(1u, static_cast<std::uint32_t>(std::sqrt(static_cast<float>(triangles) / 2)));
}

/// z = 0, or heights up to `rise`.
void add_field(std::uint32_t triangles, std::uint32_t rise, Random* random, Faces* out) {
  const std::uint32_t side = side_of(triangles);
  std::vector<float> heights((side + 1) * (side + 1));
  for (float& height : heights) height = whole(rise, random);
  const std::uint32_t half = side / 2;
  const auto middle = static_cast<float>(half);
  const auto at = [&](std::uint32_t x, std::uint32_t y) {
    return Vec3{static_cast<float>(x) - middle, static_cast<float>(y) - middle,
                heights[y * (side + 1) + x]};
  };
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      add_cell({at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)}, random, out);
}

void add_grid(std::uint32_t triangles, Random* random, Faces* out) {
  add_field(triangles, 0, random, out);
}

void add_heights(std::uint32_t triangles, Random* random, Faces* out) {
  add_field(triangles, 1 + random->below(5), random, out);
}

/// Where cells of two sizes meet, every other corner of the small ones is on an edge of the large
/// one.
void add_junctions(std::uint32_t triangles, Random* random, Faces* out) {
  const auto rows = static_cast<int>(side_of(triangles / 3));
  const auto square = [&](float x, float y, float size) {
    add_cell(
        {Vec3{x, y, x}, {x + size, y, x + size}, {x + size, y + size, x + size}, {x, y + size, x}},
        random, out);
  };
  for (int y = -rows; y < rows; ++y)
    for (int x = -rows; x < rows; ++x) {
      const auto at_x = static_cast<float>(x), at_y = static_cast<float>(y);
      if (x < 0) square(at_x, at_y, 1);
      if (x >= 0 && x % 2 == 0 && (y + rows) % 2 == 0) square(at_x, at_y, 2);
    }
}

/// Around a hub, in the order of their angles.
void add_whole_fan(std::uint32_t triangles, Random* random, Faces* out) {
  const std::uint32_t side = std::max(1u, triangles / 8);
  std::vector<Vec3> rim;
  const float half = static_cast<float>(side);
  for (std::uint32_t i = 0; i < 2 * side; ++i) {
    const float along = static_cast<float>(i) - half;
    const std::array<Vec3, 4> sides{
        Vec3{along, -half, 0}, {half, along, 0}, {-along, half, 0}, {-half, -along, 0}};
    if (rim.empty()) rim.resize(std::size_t{8} * side);
    for (std::uint32_t k = 0; k < 4; ++k) rim[k * 2 * side + i] = sides[k];
  }
  const Vec3 hub{whole(side / 2, random), whole(side / 2, random), whole(5, random)};
  for (std::size_t i = 0; i < rim.size(); ++i)
    out->push_back({hub, rim[i], rim[(i + 1) % rim.size()]});
}

void add_boxes(std::uint32_t triangles, Random* random, Faces* out) {
  while (out->size() < triangles) {
    const Vec3 low = whole_vertex(8, random), size = abs(whole_vertex(6, random)) + Vec3{1, 1, 1};
    const auto at = [&](int corner) {
      return low + size * Vec3{(corner & 1) != 0 ? 1.0f : 0, (corner & 2) != 0 ? 1.0f : 0,
                               (corner & 4) != 0 ? 1.0f : 0};
    };
    constexpr int kSides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& s : kSides) add_cell({at(s[0]), at(s[1]), at(s[2]), at(s[3])}, random, out);
  }
}

/// One in eight has no area.
void add_any(std::uint32_t triangles, Random* random, Faces* out) {
  const std::uint32_t most = random->one_in(2) ? 3 : 40;
  while (out->size() < triangles) {
    const Vec3 a = whole_vertex(most, random), b = whole_vertex(most, random);
    const Vec3 c = random->one_in(8) ? a + (b - a) * whole(2, random) : whole_vertex(most, random);
    out->push_back({a, b, c});
  }
}

struct WholeKind {
  const char* name;
  void (*add)(std::uint32_t, Random*, Faces*);
};
constexpr WholeKind kWholeKinds[] = {
    {"triangles of a whole-number grid", add_grid}, {"triangles with T-junctions", add_junctions},
    {"triangles of a fan", add_whole_fan},          {"triangles of whole-number boxes", add_boxes},
    {"triangles of a height field", add_heights},   {"whole-number triangles", add_any}};

/// Permutes the axes and reverses some.
Vec3 turned(Vec3 p, std::uint32_t turn) {
  for (std::uint32_t i = 0; i < turn % 3; ++i) p = {p.y, p.z, p.x};
  return turn >= 3 ? Vec3{-p.y, p.x, p.z} : p;
}

/// Exactly on a triangle.
Vec3 quarter_point_of(const Face& t, Random* random) {
  const std::uint32_t i = random->below(5), j = random->below(5 - i);
  return t[0] * (0.25f * static_cast<float>(i)) + t[1] * (0.25f * static_cast<float>(j)) +
         t[2] * (0.25f * static_cast<float>(4 - i - j));
}

/// Sometimes in the triangle's plane.
Vec3 step_of(const Face& t, float unit, Random* random) {
  Vec3 step = whole_vertex(random->one_in(2) ? 2 : 9, random) * unit;
  if (random->one_in(10)) {
    const Vec3 along_ac = (t[2] - t[0]) * whole(2, random);
    step = (t[1] - t[0]) * whole(2, random) + along_ac;
  }
  return max_component(abs(step)) > 0 ? step : Vec3{0, -0.0f, unit};
}

void move_off(float unit, Random* random, Ray* ray) {
  Vec3& p = random->one_in(2) ? ray->origin : ray->direction;
  float* const coordinates[] = {&p.x, &p.y, &p.z};
  float& x = *coordinates[random->below(3)];
  const float sign = random->one_in(2) ? 1.0f : -1.0f;
  if (random->one_in(2))
    x = std::nextafter(x, sign * 1e38f);
  else
    x += std::ldexp(sign * unit, -static_cast<int>(random->below(20)));
}

void give_interval_at(float t, Random* random, Ray* ray) {
  switch (random->below(10)) {
    case 0:
      ray->t_max = t;
      break;
    case 1:
      ray->t_min = t;
      break;
    case 2:
      ray->t_min = ray->t_max = t;
      break;
    case 3:
      ray->t_max = std::nextafter(t, 0.0f);
      break;
    case 4:
      ray->t_min = std::nextafter(t, 1e38f);
      break;
    default:
      break;
  }
}

}  // namespace

Soup make_whole_meshes(std::uint32_t most_triangles, Random* random) {
  const WholeKind& kind = kWholeKinds[random->below(std::size(kWholeKinds))];
  const std::uint32_t count =
      std::min(most_triangles, 12 + random->below(random->one_in(3) ? most_triangles : 60));
  Faces faces;
  kind.add(count, random, &faces);
  if (faces.size() > most_triangles) faces.resize(most_triangles);
  Soup soup;
  soup.kind = kind.name;
  const int power = random->one_in(2) ? 0 : static_cast<int>(random->below(60)) - 30;
  soup.scale = std::ldexp(1.0f, power);
  if (random->one_in(4)) soup.offset = whole_vertex(25000, random) * (kUnit * soup.scale);
  const std::uint32_t turn = random->below(6);
  // Neighbours are consecutive, or in random order.
  if (random->one_in(2))
    for (std::size_t i = faces.size(); i > 1; --i)
      std::swap(faces[i - 1], faces[random->below(static_cast<std::uint32_t>(i))]);
  for (std::size_t first = 0; first < faces.size();) {
    const std::size_t last = std::min<std::size_t>(faces.size(), first + 1 + random->below(100));
    std::vector<Vec3>& mesh = soup.meshes.emplace_back();
    for (; first < last; ++first)
      for (const Vec3 p : faces[first])
        mesh.push_back(turned(p, turn) * (kUnit * soup.scale) + soup.offset);
  }
  return soup;
}

std::vector<Ray> make_whole_rays(const Soup& soup, std::size_t count, bool one_origin,
                                 Random* random) {
  const float unit = soup.scale;
  const auto somewhere = [&] { return whole_vertex(40, random) * unit + soup.offset; };
  const Vec3 origin =
      random->one_in(4) ? quarter_point_of(soup.some_triangle(random), random) : somewhere();
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Face face = soup.some_triangle(random);
    const Vec3 target = quarter_point_of(face, random), step = step_of(face, unit, random);
    const auto steps = static_cast<float>(random->below(8));
    const auto length = static_cast<float>(1 + random->below(random->one_in(2) ? 1 : 7));
    Ray ray{target - step * steps, 0, step * length, std::numeric_limits<float>::infinity()};
    float t = steps / length;
    if (one_origin || random->one_in(4)) {
      ray.origin = one_origin ? origin : somewhere();
      ray.direction = (target - ray.origin) * length;
      t = 1 / length;
    }
    if (random->one_in(3)) move_off(unit, random, &ray);
    if (one_origin) ray.origin = origin;
    give_interval_at(t, random, &ray);
    if (is_finite(ray.origin) && is_finite(ray.direction) && max_component(abs(ray.direction)) > 0)
      rays.push_back(ray);
  }
  return rays;
}

}  // namespace raysheaf::checks
