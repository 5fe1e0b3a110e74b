// Surfaces along paths, and parametric ones.
#include <algorithm>
#include <array>

#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

Vec3 in_plane(Vec2 p) {
  return {p.x, p.y, 0};
}

/// The vertices of one side of a sweep at one frame, at the side's first and second point.
struct Rung {
  std::uint32_t first, second;
};

void add_side(MeshBuilder& builder, std::span<const Vec2> outline, std::size_t side,
              LineNormals normals, const Path& path, Ends ends) {
  const Vec2 a = outline[side], b = outline[(side + 1) % outline.size()];
  const auto along = distances(outline, true);
  std::vector<Rung> rungs;
  float travelled = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) travelled += length(column(path[i], 3) - column(path[i - 1], 3));
    const auto vertex = [&](Vec2 p, Vec2 n, float u) {
      return builder.add_vertex(transform_point(path[i], in_plane(p)),
                                transform_normal(path[i], in_plane(n)), {u, travelled});
    };
    rungs.push_back(
        {vertex(a, normals.first, along[side]), vertex(b, normals.second, along[side + 1])});
  }
  if (ends == Ends::kJoined) rungs.push_back(rungs.front());
  for (std::size_t i = 0; i + 1 < rungs.size(); ++i) {
    builder.add_quad(rungs[i].first, rungs[i].second, rungs[i + 1].second, rungs[i + 1].first);
  }
}

void add_cap(MeshBuilder& builder, std::span<const Vec2> outline, const Affine& frame, bool front) {
  std::vector<std::uint32_t> ids;
  const Vec3 normal = transform_normal(frame, {0, 0, front ? 1.0f : -1.0f});
  for (const Vec2 p : outline) {
    ids.push_back(builder.add_vertex(transform_point(frame, in_plane(p)), normal, p));
  }
  for (std::size_t i = 1; i + 1 < ids.size(); ++i) {
    builder.add_triangle(ids[0], ids[front ? i : i + 1], ids[front ? i + 1 : i]);
  }
}

Affine frame_of(Vec3 x, Vec3 y, Vec3 z, Vec3 origin) {
  Affine a;
  a.m[0] = {x.x, y.x, z.x, origin.x};
  a.m[1] = {x.y, y.y, z.y, origin.y};
  a.m[2] = {x.z, y.z, z.z, origin.z};
  return a;
}

/// About +z, exactly, so that mitred ends meet in the same points.
Affine quarter_turns(int count) {
  const float c = count == 0 ? 1.0f : count == 2 ? -1.0f : 0.0f;
  const float s = count == 1 ? 1.0f : count == 3 ? -1.0f : 0.0f;
  Affine a;
  a.m = {{{c, -s, 0, 0}, {s, c, 0, 0}, {0, 0, 1, 0}}};
  return a;
}

}  // namespace

void add_sweep(MeshBuilder& builder, std::span<const Vec2> outline, const Path& path, Ends ends) {
  const auto normals = line_normals(outline, true);
  for (std::size_t side = 0; side < outline.size(); ++side) {
    add_side(builder, outline, side, normals[side], path, ends);
  }
  if (ends != Ends::kCapped) return;
  add_cap(builder, outline, path.front(), false);
  add_cap(builder, outline, path.back(), true);
}

void add_prism(MeshBuilder& builder, std::span<const Vec2> outline, float depth) {
  add_sweep(builder, outline, {Affine{}, translation({0, 0, depth})});
}

Path path_along(std::span<const Vec3> points) {
  Path path;
  Vec3 x;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 before = points[i == 0 ? 0 : i - 1];
    const Vec3 after = points[std::min(i + 1, points.size() - 1)];
    const Vec3 z = normalized(after - before);
    if (i == 0) x = std::fabs(z.y) < 0.9f ? cross({0, 1, 0}, z) : cross({1, 0, 0}, z);
    x = normalized(x - z * dot(x, z));
    path.push_back(frame_of(x, cross(z, x), z, points[i]));
  }
  return path;
}

void add_tube(MeshBuilder& builder, std::span<const Vec3> points, float first_radius,
              float last_radius, int sides) {
  Path path = path_along(points);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(path.size() - 1);
    const float radius = first_radius + (last_radius - first_radius) * t;
    path[i] = compose(path[i], scaling({radius, radius, 1}));
  }
  add_sweep(builder, circle(1, sides), path);
}

void add_moulding(MeshBuilder& builder, float width, float height, std::span<const Vec2> outline) {
  const Affine frame = builder.frame();
  for (int side = 0; side < 4; ++side) {
    const float length = side % 2 == 0 ? width : height, across = side % 2 == 0 ? height : width;
    builder.at(compose(frame, quarter_turns(side)));
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec2 p = outline[i], q = outline[(i + 1) % outline.size()];
      const auto corner = [&](Vec2 at, float end) {
        return Vec3{end * (length / 2 + at.x), -across / 2 - at.x, at.y};
      };
      const Vec3 n = normalized({0, q.y - p.y, q.x - p.x});
      const auto vertex = [&](Vec2 at, float end) {
        const Vec3 position = corner(at, end);
        return builder.add_vertex(position, n, {position.x, at.x + at.y});
      };
      // One after the other: compilers evaluate the arguments of a call in different orders.
      const auto d = vertex(p, 1), c = vertex(q, 1), b = vertex(q, -1), a = vertex(p, -1);
      builder.add_quad(a, b, c, d);
    }
  }
  builder.at(frame);
}

void add_surface(MeshBuilder& builder, int columns, int rows,
                 const std::function<Vec3(float, float)>& f, bool closed_u) {
  const auto point = [&](int i, int j) {
    const int column = closed_u ? (i + columns) % columns : std::clamp(i, 0, columns);
    return f(static_cast<float>(column) / static_cast<float>(columns),
             static_cast<float>(std::clamp(j, 0, rows)) / static_cast<float>(rows));
  };
  std::vector<std::uint32_t> ids;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const Vec3 n = cross(point(i + 1, j) - point(i - 1, j), point(i, j + 1) - point(i, j - 1));
      ids.push_back(builder.add_vertex(point(i, j), normalized(n),
                                       {static_cast<float>(i) / static_cast<float>(columns),
                                        static_cast<float>(j) / static_cast<float>(rows)}));
    }
  }
  const auto id = [&](int i, int j) {
    const std::size_t row = static_cast<std::size_t>(columns) + 1;
    return ids[static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i)];
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      builder.add_quad(id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
    }
  }
}

std::vector<Vec3> arc(Vec3 center, float radius, float from, float to, int steps) {
  std::vector<Vec3> result;
  for (int i = 0; i <= steps; ++i) {
    const float angle =
        radians(from + (to - from) * static_cast<float>(i) / static_cast<float>(steps));
    result.push_back(center + Vec3{std::cos(angle), std::sin(angle), 0} * radius);
  }
  return result;
}

}  // namespace raysheaf::builtin
