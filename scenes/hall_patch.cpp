#include "scenes/hall_patch.h"

#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "scenes/builder.h"
#include "scenes/hall_grid.h"

namespace raysheaf::builtin {
namespace {

/// A value in [0, 1) at a corner of the lattice. The factors are those of Teschner et al.,
/// "Optimized Spatial Hashing for Collision Detection of Deformable Objects", 2003; the last step
/// is PCG's output permutation.
float lattice_value(std::int32_t x, std::int32_t y, std::int32_t z) {
  const std::uint32_t state = static_cast<std::uint32_t>(x) * 73856093u ^
                              static_cast<std::uint32_t>(y) * 19349663u ^
                              static_cast<std::uint32_t>(z) * 83492791u;
  const std::uint32_t mixed = state * 747796405u + 2891336453u;
  const std::uint32_t word = ((mixed >> ((mixed >> 28) + 4)) ^ mixed) * 277803737u;
  return static_cast<float>(((word >> 22) ^ word) >> 8) * 0x1p-24f;
}

float faded(float t) {
  return t * t * (3 - 2 * t);
}

float between(float a, float b, float t) {
  return a + (b - a) * t;
}

/// K. Perlin's lattice noise with values instead of gradients ("An Image Synthesizer", 1985).
float noise(Vec3 p) {
  const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const auto x = static_cast<std::int32_t>(fx), y = static_cast<std::int32_t>(fy),
             z = static_cast<std::int32_t>(fz);
  const float u = faded(p.x - fx), v = faded(p.y - fy), w = faded(p.z - fz);
  const auto along_x = [&](std::int32_t j, std::int32_t k) {
    return between(lattice_value(x, y + j, z + k), lattice_value(x + 1, y + j, z + k), u);
  };
  const auto layer = [&](std::int32_t k) { return between(along_x(0, k), along_x(1, k), v); };
  return between(layer(0), layer(1), w);
}

/// In [0, 1): four octaves, the coarsest a metre wide.
float rough(Vec3 p) {
  float sum = 0, weight = 0.5f;
  for (int octave = 0; octave < 4; ++octave, weight *= 0.5f, p = p * 2.0f) sum += weight * noise(p);
  return sum;
}

/// 0 at both ends of [0, 1], 1 inside.
float window(float t) {
  return faded(std::clamp(10 * std::min(t, 1 - t), 0.0f, 1.0f));
}

struct Sample {
  Vec3 position, normal;
  float weight = 1;  ///< of the displacement
};

Sample wall_sample(const HallPatch& p, float u, float v) {
  return {p.origin + p.a * u + p.b * v, normalized(cross(p.a, p.b)), window(u) * window(v)};
}

Vec3 on_circle(float u) {
  const float angle = 2 * kPi * u;
  return {std::cos(angle), 0, -std::sin(angle)};
}

Sample column_sample(const HallPatch& p, float u, float v) {
  const Vec3 outward = on_circle(u);
  return {p.origin + p.b * v + outward * length(p.a), outward, 1};
}

Sample ball_sample(const HallPatch& p, float u, float v) {
  const float angle = kPi * v;
  const bool pole = v <= 0 || v >= 1;
  const Vec3 outward = pole ? Vec3{0, v <= 0 ? -1.0f : 1.0f, 0}
                            : on_circle(u) * std::sin(angle) + Vec3{0, -std::cos(angle), 0};
  return {p.origin + outward * length(p.a), outward, 1};
}

}  // namespace

Vec3 displaced(const HallPatch& p, float u, float v) {
  const Sample s = p.shape == HallPatch::Shape::kWall     ? wall_sample(p, u, v)
                   : p.shape == HallPatch::Shape::kColumn ? column_sample(p, u, v)
                                                          : ball_sample(p, u, v);
  return s.position + s.normal * (p.roughness * s.weight * rough(s.position));
}

namespace {

std::uint32_t cells(float length, float cells_a_length, std::uint32_t least) {
  return std::max(least, static_cast<std::uint32_t>(std::lround(length * cells_a_length)));
}

}  // namespace

PatchExtent extent(const HallPatch& patch) {
  const float around = 2 * kPi * length(patch.a);
  if (patch.shape == HallPatch::Shape::kWall) return {length(patch.a), length(patch.b)};
  return {around, patch.shape == HallPatch::Shape::kColumn ? length(patch.b) : around / 2};
}

PatchGrid grid_of(const HallPatch& patch, float cells_a_length) {
  const PatchExtent e = extent(patch);
  return {cells(e.u, cells_a_length, 3), cells(e.v, cells_a_length, 2)};
}

std::uint64_t triangle_count(const HallPatch& patch, PatchGrid grid) {
  const std::uint64_t rows = patch.shape == HallPatch::Shape::kBall ? grid.rows - 1 : grid.rows;
  return 2 * rows * grid.columns;
}

Mesh hall_mesh(const Executor& executor, const HallPatch& patch, PatchGrid size) {
  const Grid grid(patch, size);
  Mesh mesh;
  mesh.name = patch.name;
  mesh.positions.resize(grid.vertex_count());
  mesh.normals.resize(grid.vertex_count());
  mesh.triangles.resize(triangle_count(patch, size));
  const auto index = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
  executor.for_each(mesh.positions.size(), kCopyGrain,
                    [&](std::size_t i) { mesh.positions[i] = grid.position(index(i)); });
  executor.for_each(mesh.normals.size(), kCopyGrain, [&](std::size_t i) {
    mesh.normals[i] = grid.normal(index(i), [&](std::uint32_t column, std::uint32_t row) {
      return mesh.positions[grid.vertex(column, row)];
    });
  });
  executor.for_each(size.rows, 16, [&](std::size_t row) {
    grid.add_cells(index(row), mesh.triangles.data() + grid.first_triangle(index(row)));
  });
  mesh.materials = {0};
  return mesh;
}

}  // namespace raysheaf::builtin
