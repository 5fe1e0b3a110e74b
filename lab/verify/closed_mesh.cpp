#include "lab/verify/closed_mesh.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "base/float.h"
#include "scene/flatten_body.h"

namespace raysheaf::checks {
namespace {

constexpr float kTurn = 6.28318530718f;
/// Roundings of the farthest coordinate that fit between a core and the surface.
constexpr float kRoundings = 4096;

void push(Vec3 p, Vec3 core, ClosedMesh* mesh) {
  mesh->positions.push_back(p);
  mesh->cores.push_back(core);
}

/// Splits each triangle into four, and moves new vertices to the unit sphere.
void refine(ClosedMesh* mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto count = static_cast<std::uint32_t>(mesh->positions.size());
    const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), count);
    if (is_new) push(normalized(mesh->positions[a] + mesh->positions[b]), {}, mesh);
    return place->second;
  };
  std::vector<Triangle> finer;
  for (const auto& [a, b, c] : mesh->triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  mesh->triangles = std::move(finer);
}

void make_ball(Random* random, ClosedMesh* mesh) {
  mesh->kind = "ball";
  for (const float side : {1.0f, -1.0f})
    for (const Vec3 p : {Vec3{side, 0, 0}, {0, side, 0}, {0, 0, side}}) push(p, {}, mesh);
  mesh->triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                     {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (std::uint32_t step = random->below(5); step > 0; --step) refine(mesh);
  mesh->thickness = 0.3f;
}

/// A grid of integers on the sides of a cube: rays hit edges and vertices exactly.
void make_box(Random* random, ClosedMesh* mesh) {
  mesh->kind = "box";
  const int cells = 1 << random->below(5);
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<int, 3> p) {
    const auto [place, is_new] =
        known.try_emplace(p, static_cast<std::uint32_t>(mesh->positions.size()));
    const auto at = [&](int axis) {
      return static_cast<float>(2 * p[axis] - cells) / static_cast<float>(cells);
    };
    if (is_new) push({at(0), at(1), at(2)}, {}, mesh);
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, cells})
      for (int i = 0; i < cells; ++i)
        for (int k = 0; k < cells; ++k) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> p{};
            p[axis] = side, p[(axis + 1) % 3] = u, p[(axis + 2) % 3] = v;
            return vertex(p);
          };
          const std::uint32_t a = at(i, k), b = at(i + 1, k), c = at(i + 1, k + 1),
                              d = at(i, k + 1);
          mesh->triangles.push_back({a, b, c});
          mesh->triangles.push_back({a, c, d});
        }
  mesh->thickness = 0.5f;
}

void make_torus(Random* random, ClosedMesh* mesh) {
  mesh->kind = "torus";
  const std::uint32_t around = 12 + random->below(50), across = 3 + random->below(20);
  const float radius = 0.3f;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t k = 0; k < across; ++k) {
      const float u = kTurn * static_cast<float>(i) / static_cast<float>(around);
      const float v = kTurn * static_cast<float>(k) / static_cast<float>(across);
      const Vec3 out{std::cos(u), std::sin(u), 0}, core = out * 0.7f;
      push(core + out * (radius * std::cos(v)) + Vec3{0, 0, radius * std::sin(v)}, core, mesh);
    }
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t k = 0; k < across; ++k) {
      const std::uint32_t j = (i + 1) % around, l = (k + 1) % across;
      const auto at = [&](std::uint32_t x, std::uint32_t y) { return x * across + y; };
      mesh->triangles.push_back({at(i, k), at(j, k), at(i, l)});
      mesh->triangles.push_back({at(j, k), at(j, l), at(i, l)});
    }
  mesh->thickness = 0.05f;
}

/// Two cones with a common rim: each pole is a corner of every triangle of its side.
void make_spindle(Random* random, ClosedMesh* mesh) {
  mesh->kind = "spindle";
  const std::uint32_t rim = 3 + random->below(400);
  push({0, 0, 1}, {}, mesh);
  push({0, 0, -1}, {}, mesh);
  for (std::uint32_t i = 0; i < rim; ++i) {
    const float u = kTurn * static_cast<float>(i) / static_cast<float>(rim);
    push({std::cos(u), std::sin(u), 0}, {}, mesh);
  }
  for (std::uint32_t i = 0; i < rim; ++i) {
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % rim;
    mesh->triangles.push_back({a, b, 0});
    mesh->triangles.push_back({b, a, 1});
  }
  mesh->thickness = 0.2f;
}

void roughen(Random* random, ClosedMesh* mesh) {
  for (std::size_t i = 0; i < mesh->positions.size(); ++i)
    mesh->positions[i] = lerp(mesh->cores[i], mesh->positions[i], random->between(0.7f, 1));
  mesh->thickness *= 0.05f;  // faces may be steep
  mesh->kind = "rough " + mesh->kind;
}

void stretch(Random* random, ClosedMesh* mesh) {
  const float thin = random->magnitude(-4, -1);
  const Vec3 by = random->one_in(2) ? Vec3{1, thin, thin} : Vec3{thin, 1, random->between(thin, 1)};
  for (std::vector<Vec3>* points : {&mesh->positions, &mesh->cores})
    for (Vec3& p : *points) p = p * by;
  mesh->thickness *= thin;
  mesh->kind += " of needles";
}

/// Rotates the mesh so that nothing is aligned with the axes, scales and moves it.
void place(Random* random, ClosedMesh* mesh) {
  Affine turn;
  if (random->one_in(2)) {
    const float angle = random->between(0, kTurn);
    turn = rotation(random->direction(), angle);
  }
  const float scale = random->one_in(3) ? 1 : random->magnitude(-20, 16.5f);
  mesh->extent = 2 * scale;
  mesh->thickness *= scale;
  if (random->one_in(2)) {
    // Limited so that roundings of the coordinates do not fill the mesh.
    const float farthest = std::min(mesh->thickness / (kRoundings * kUnitRoundoff), 4e17f);
    const float distance = farthest * random->magnitude(-4, -0.5f);
    mesh->offset = random->direction() * distance;
  }
  for (std::vector<Vec3>* points : {&mesh->positions, &mesh->cores})
    for (Vec3& p : *points) p = transform_point(turn, p) * scale + mesh->offset;
}

/// Whether rounding has put three different corners on one line.
bool has_flat_triangle(const ClosedMesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return has_no_area(a, b, c) && !(a == b) && !(b == c) && !(c == a);
  });
}

ClosedMesh some_mesh(Random* random) {
  constexpr void (*kShapes[])(Random*, ClosedMesh*) = {make_ball, make_box, make_torus,
                                                       make_spindle};
  ClosedMesh mesh;
  kShapes[random->below(std::size(kShapes))](random, &mesh);
  if (random->one_in(2)) roughen(random, &mesh);
  if (random->one_in(2)) stretch(random, &mesh);
  place(random, &mesh);
  return mesh;
}

}  // namespace

std::string ClosedMesh::text() const {
  char size[32];
  std::snprintf(size, sizeof size, "%.3g", static_cast<double>(extent));
  return kind + " of " + std::to_string(triangles.size()) + " triangles, " + size + " large, at (" +
         std::to_string(offset.x) + ", " + std::to_string(offset.y) + ", " +
         std::to_string(offset.z) + ")";
}

ClosedMesh make_closed_mesh(std::uint64_t seed) {
  for (std::uint64_t trial = 0;; ++trial) {
    Random random(seed, trial);
    ClosedMesh mesh = some_mesh(&random);
    if (!has_flat_triangle(mesh)) return mesh;
  }
}

}  // namespace raysheaf::checks
