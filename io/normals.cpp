#include "io/normals.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "io/corner_normals.h"

namespace raysheaf::io {
namespace {

std::vector<Double3> face_normals(const Mesh& mesh) {
  std::vector<Double3> normals;
  normals.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles)
    normals.push_back(face_normal(mesh.positions[a], mesh.positions[b], mesh.positions[c]));
  return normals;
}

/// For each vertex, an id that vertices at the same position share.
std::vector<std::uint32_t> position_ids(const std::vector<Vec3>& positions) {
  const auto key = [&](std::uint32_t v) {
    const Vec3& p = positions[v];
    return std::array<float, 3>{p.x, p.y, p.z};
  };
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<std::uint32_t> ids(positions.size());
  std::uint32_t id = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i - 1]) != key(order[i])) ++id;
    ids[order[i]] = id;
  }
  return ids;
}

/// The corners (3 * triangle + k) that touch each position, in file order.
struct Incidence {
  std::vector<std::size_t> first;  ///< one entry more than there are positions
  std::vector<std::size_t> corners;
};

Incidence corners_of_positions(const Mesh& mesh) {
  const std::vector<std::uint32_t> ids = position_ids(mesh.positions);
  Incidence result;
  result.first.assign(mesh.positions.size() + 1, 0);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) ++result.first[ids[v] + 1];
  }
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.corners.resize(3 * mesh.triangles.size());
  std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
  for (std::size_t c = 0; c < result.corners.size(); ++c) {
    result.corners[next[ids[mesh.triangles[c / 3][c % 3]]]++] = c;
  }
  return result;
}

std::vector<Vec3> corner_normals(const Mesh& mesh, const std::vector<std::uint32_t>& smoothing) {
  const std::vector<Double3> faces = face_normals(mesh);
  const Incidence incidence = corners_of_positions(mesh);
  std::vector<Vec3> normals(3 * mesh.triangles.size());
  std::array<Double3, kMaxFacesAtPosition> run;
  std::array<std::uint32_t, kMaxFacesAtPosition> groups;
  std::array<Vec3, kMaxFacesAtPosition> smooth;
  for (std::size_t p = 0; p < mesh.positions.size(); ++p) {
    for (std::size_t i = incidence.first[p]; i < incidence.first[p + 1]; i += kMaxFacesAtPosition) {
      const std::size_t end = std::min(i + kMaxFacesAtPosition, incidence.first[p + 1]);
      for (std::size_t c = i; c < end; ++c) {
        const std::size_t face = incidence.corners[c] / 3;
        run[c - i] = faces[face];
        groups[c - i] = smoothing.empty() ? kByAngle : smoothing[face];
      }
      smooth_run({run.data(), end - i}, {groups.data(), end - i}, {smooth.data(), end - i});
      for (std::size_t c = i; c < end; ++c) normals[incidence.corners[c]] = smooth[c - i];
    }
  }
  return normals;
}

}  // namespace

void smooth_run(std::span<const Double3> faces, std::span<const std::uint32_t> smoothing,
                std::span<Vec3> normals) {
  for (std::size_t c = 0; c < faces.size(); ++c) {
    const Double3 own = faces[c];
    const double own_squared = dot(own, own);
    const std::uint32_t group = smoothing[c];
    const auto no_crease = [&](Double3 normal) {
      const double cosine = dot(own, normal);
      return cosine > 0 &&
             cosine * cosine >= kCreaseCosine * kCreaseCosine * own_squared * dot(normal, normal);
    };
    Double3 sum;
    for (std::size_t other = 0; group != kFlat && other < faces.size(); ++other) {
      if (smoothing[other] == group &&
          (group != kByAngle || own_squared == 0 || no_crease(faces[other])))
        sum = sum + faces[other];
    }
    normals[c] = narrow(normalized(sum, normalized(own, {0, 0, 1})));
  }
}

std::vector<std::uint32_t> add_missing_normals(Mesh& mesh, const std::vector<bool>& has_normal,
                                               const std::vector<std::uint32_t>& smoothing) {
  const std::vector<Vec3> corners = corner_normals(mesh, smoothing);
  const auto before = static_cast<std::ptrdiff_t>(mesh.positions.size());
  mesh.normals.resize(mesh.positions.size(), Vec3{0, 0, 1});
  std::vector<std::uint32_t> newest, previous;
  VertexSplitter splitter(mesh, newest, previous);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    std::uint32_t& vertex = mesh.triangles[c / 3][c % 3];
    if (vertex < has_normal.size() && has_normal[vertex]) continue;
    vertex = splitter.vertex_with(vertex, corners[c]);
  }
  return {previous.begin() + before, previous.end()};
}

}  // namespace raysheaf::io
