#include "scenes/shapes.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace raysheaf::builtin {
namespace {

struct Turn {
  float c, s;
};

std::vector<Turn> turns(int segments) {
  std::vector<Turn> result;
  for (int j = 0; j <= segments; ++j) {
    const float angle = 2 * kPi * static_cast<float>(j % segments) / static_cast<float>(segments);
    result.push_back({std::cos(angle), std::sin(angle)});
  }
  return result;
}

std::uint32_t add_turned(MeshBuilder& builder, Vec2 p, Vec2 n, Turn t, Vec2 uv) {
  return builder.add_vertex({p.x * t.c, p.y, -p.x * t.s}, {n.x * t.c, n.y, -n.x * t.s}, uv);
}

/// One vertex for each turn.
std::vector<std::uint32_t> add_ring(MeshBuilder& builder, Vec2 p, Vec2 n, float v,
                                    std::span<const Turn> around) {
  std::vector<std::uint32_t> ring;
  for (std::size_t j = 0; j < around.size(); ++j) {
    const float u = static_cast<float>(j) / static_cast<float>(around.size() - 1);
    ring.push_back(add_turned(builder, p, n, around[j], {u, v}));
  }
  return ring;
}

/// A ring of vertices on the axis, each with the normal halfway to the next. They share a normal
/// along the axis if the surface is nearly flat.
std::vector<std::uint32_t> add_pole(MeshBuilder& builder, Vec2 p, Vec2 n, float v, int segments) {
  n = blended_normal(n, {-n.x, n.y});
  std::vector<std::uint32_t> ring;
  for (int j = 0; j < segments; ++j) {
    const float u = (static_cast<float>(j) + 0.5f) / static_cast<float>(segments);
    const Turn halfway{std::cos(2 * kPi * u), std::sin(2 * kPi * u)};
    ring.push_back(add_turned(builder, p, n, halfway, {u, v}));
  }
  return ring;
}

/// A vertical line of a rounded box: the centre of its corner, and the direction from there.
struct Column {
  float cx, cz;
  Turn direction;
};

std::vector<Column> rounded_columns(Vec3 half, float radius, int steps) {
  constexpr std::array<Turn, 4> kQuadrants = {{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  std::vector<Column> result;
  for (int q = 0; q < 4; ++q) {
    for (int j = 0; j <= steps; ++j) {
      const float angle =
          radians(90) * (static_cast<float>(q) + static_cast<float>(j) / static_cast<float>(steps));
      const Turn sign = kQuadrants[static_cast<std::size_t>(q)];
      result.push_back({sign.c * (half.x - radius),
                        -sign.s * (half.z - radius),
                        {std::cos(angle), std::sin(angle)}});
    }
  }
  return result;
}

/// Texture coordinates of a box: seen along the axis closest to `n`.
Vec2 box_uv(Vec3 p, Vec3 n) {
  if (std::fabs(n.y) > 0.7f) return {p.x, p.z};
  return std::fabs(n.x) > 0.7f ? Vec2{p.z, p.y} : Vec2{p.x, p.y};
}

/// A horizontal line of a rounded box: the height of its corners' centres, and the steepness above
/// there.
struct Row {
  float cy;
  Turn slope;
};

/// From the lowest to the highest; each quarter turn has its own first and last row.
std::vector<Row> rounded_rows(float half, float radius, int steps) {
  std::vector<Row> result;
  for (int j = 0; j <= steps; ++j) {
    const float angle = radians(90) * static_cast<float>(steps - j) / static_cast<float>(steps);
    result.push_back({radius - half, {j == 0 ? 0 : std::cos(angle), -std::sin(angle)}});
  }
  for (int j = steps; j >= 0; --j) {
    const Turn slope = result[static_cast<std::size_t>(j)].slope;
    result.push_back({half - radius, {slope.c, -slope.s}});
  }
  return result;
}

}  // namespace

void add_quad(MeshBuilder& builder, Vec3 corner, Vec3 u, Vec3 v, Vec2 uv_scale) {
  const Vec3 n = normalized(cross(u, v));
  const auto a = builder.add_vertex(corner, n, {0, uv_scale.y});
  const auto b = builder.add_vertex(corner + u, n, {uv_scale.x, uv_scale.y});
  const auto c = builder.add_vertex(corner + u + v, n, {uv_scale.x, 0});
  const auto d = builder.add_vertex(corner + v, n, {0, 0});
  builder.add_quad(a, b, c, d);
}

void add_box(MeshBuilder& builder, Vec3 min, Vec3 max) {
  const Vec3 s = max - min, x{s.x, 0, 0}, y{0, s.y, 0}, z{0, 0, s.z};
  add_quad(builder, min + z, x, y, {s.x, s.y});
  add_quad(builder, min + x, -x, y, {s.x, s.y});
  add_quad(builder, min + x + z, -z, y, {s.z, s.y});
  add_quad(builder, min, z, y, {s.z, s.y});
  add_quad(builder, min + y + z, x, -z, {s.x, s.z});
  add_quad(builder, min, x, z, {s.x, s.z});
}

void add_rounded_box(MeshBuilder& builder, Vec3 min, Vec3 max, float radius, int steps) {
  const Vec3 center = (min + max) * 0.5f, half = (max - min) * 0.5f;
  const auto columns = rounded_columns(half, radius, steps);
  const auto rows = rounded_rows(half.y, radius, steps);
  const std::size_t n = columns.size(), top = rows.size() - 1, corner = n / 4;
  assert(n > 0);
  std::vector<std::uint32_t> ids;
  for (const Row& row : rows) {
    for (const Column& column : columns) {
      const float c = row.slope.c;
      const Vec3 normal{c * column.direction.c, row.slope.s, -c * column.direction.s};
      const Vec3 p = Vec3{column.cx, row.cy, column.cz} + normal * radius;
      ids.push_back(builder.add_vertex(center + p, normal, box_uv(p, normal)));
    }
  }
  const auto id = [&](std::size_t row, std::size_t column) { return ids[row * n + column % n]; };
  for (std::size_t i = 0; i < top; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const auto a = id(i, j), b = id(i, j + 1), c = id(i + 1, j + 1), d = id(i + 1, j);
      // The columns of a corner meet in one point at the bottom and the top.
      const bool same_corner = (j + 1) % corner != 0;
      if (!same_corner || i != 0) builder.add_triangle(a, b, same_corner && i + 1 == top ? d : c);
      if (!same_corner || i + 1 != top) builder.add_triangle(a, c, d);
    }
  }
  builder.add_quad(id(top, 0), id(top, corner), id(top, 2 * corner), id(top, 3 * corner));
  builder.add_quad(id(0, 3 * corner), id(0, 2 * corner), id(0, corner), id(0, 0));
}

void add_lathe(MeshBuilder& builder, std::span<const Vec2> profile, int segments) {
  const auto around = turns(segments);
  const auto normals = line_normals(profile, false);
  const auto heights = distances(profile, false);
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const Vec2 a = profile[i], b = profile[i + 1];
    const bool from_pole = a.x == 0, to_pole = b.x == 0;
    if (from_pole && to_pole) continue;
    const float v0 = -heights[i], v1 = -heights[i + 1];
    const auto lower = from_pole ? add_pole(builder, a, normals[i].first, v0, segments)
                                 : add_ring(builder, a, normals[i].first, v0, around);
    const auto upper = to_pole ? add_pole(builder, b, normals[i].second, v1, segments)
                               : add_ring(builder, b, normals[i].second, v1, around);
    for (std::size_t j = 0; j + 1 < around.size(); ++j) {
      if (from_pole) {
        builder.add_triangle(lower[j], upper[j + 1], upper[j]);
      } else if (to_pole) {
        builder.add_triangle(lower[j], lower[j + 1], upper[j]);
      } else {
        builder.add_quad(lower[j], lower[j + 1], upper[j + 1], upper[j]);
      }
    }
  }
}

void add_sphere(MeshBuilder& builder, Vec3 center, float radius, int segments, int rings) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= rings; ++i) {
    const float angle = kPi * (static_cast<float>(i) / static_cast<float>(rings) - 0.5f);
    const bool pole = i == 0 || i == rings;
    profile.push_back({pole ? 0 : radius * std::cos(angle), center.y + radius * std::sin(angle)});
  }
  const Affine frame = builder.frame();
  builder.at(compose(frame, translation({center.x, 0, center.z})));
  add_lathe(builder, profile, segments);
  builder.at(frame);
}

void add_cylinder(MeshBuilder& builder, Vec3 bottom, float radius, float height, int segments) {
  const Affine frame = builder.frame();
  builder.at(compose(frame, translation(bottom)));
  add_lathe(builder, std::array<Vec2, 4>{{{0, 0}, {radius, 0}, {radius, height}, {0, height}}},
            segments);
  builder.at(frame);
}

}  // namespace raysheaf::builtin
