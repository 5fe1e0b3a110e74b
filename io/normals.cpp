#include "io/normals.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

#include "io/linear.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

/// The normal of each face: its length is twice the area; zero where the face has none.
std::vector<Double3> face_normals(const Mesh& mesh) {
  std::vector<Double3> normals;
  normals.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Double3 a = widen(mesh.positions[t[0]]);
    normals.push_back(cross(widen(mesh.positions[t[1]]) - a, widen(mesh.positions[t[2]]) - a));
  }
  return normals;
}

/// A number for each vertex that vertices at the same position share.
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
  std::vector<std::size_t> first;  ///< one more than there are positions
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

/// Normals of the corners `[first, last)`, which touch one position.
void smooth_run(const std::size_t* first, const std::size_t* last,
                const std::vector<Double3>& faces, std::vector<Vec3>& normals) {
  for (const std::size_t* c = first; c != last; ++c) {
    const Double3 own = faces[*c / 3];
    const double own_squared = dot(own, own);
    Double3 sum;
    for (const std::size_t* other = first; other != last; ++other) {
      const Double3 normal = faces[*other / 3];
      const double cosine = dot(own, normal);
      const bool smooth = cosine > 0 && cosine * cosine >= kCreaseCosine * kCreaseCosine *
                                                               own_squared * dot(normal, normal);
      if (smooth || own_squared == 0) sum = sum + normal;
    }
    normals[*c] = narrow(normalized(sum, normalized(own, {0, 0, 1})));
  }
}

std::vector<Vec3> corner_normals(const Mesh& mesh) {
  const std::vector<Double3> faces = face_normals(mesh);
  const Incidence incidence = corners_of_positions(mesh);
  std::vector<Vec3> normals(3 * mesh.triangles.size());
  for (std::size_t p = 0; p < mesh.positions.size(); ++p) {
    for (std::size_t i = incidence.first[p]; i < incidence.first[p + 1]; i += kMaxFacesAtPosition) {
      const std::size_t end = std::min(i + kMaxFacesAtPosition, incidence.first[p + 1]);
      smooth_run(&incidence.corners[i], incidence.corners.data() + end, faces, normals);
    }
  }
  return normals;
}

/// Finds, or makes, the copy of a vertex that has a given normal. The copies of a vertex are a list
/// of which only the newest few are searched, so that many of them cost no more than memory.
class VertexSplitter {
 public:
  VertexSplitter(Mesh& mesh, const std::vector<bool>& has_normal)
      : mesh_(mesh), settled_(has_normal), previous_(mesh.positions.size(), kInvalidId) {
    settled_.resize(mesh.positions.size(), false);
    newest_.resize(mesh.positions.size());
    std::iota(newest_.begin(), newest_.end(), 0u);
  }

  std::uint32_t vertex_with(std::uint32_t vertex, Vec3 normal) {
    if (!settled_[vertex]) {
      settled_[vertex] = true;
      mesh_.normals[vertex] = normal;
      return vertex;
    }
    std::uint32_t copy = newest_[vertex];
    for (int step = 0; step < kSearched && copy != kInvalidId; ++step, copy = previous_[copy]) {
      if (std::memcmp(&mesh_.normals[copy], &normal, sizeof normal) == 0) return copy;
    }
    return append_copy(vertex, normal);
  }

 private:
  static constexpr int kSearched = 8;

  std::uint32_t append_copy(std::uint32_t vertex, Vec3 normal) {
    const std::size_t index = mesh_.positions.size();
    if (index >= kInvalidId) {
      throw Error(ErrorCode::kOutOfMemory, "the mesh needs more than 2^32 vertices", mesh_.name);
    }
    const Vec3 position = mesh_.positions[vertex];
    mesh_.positions.push_back(position);
    mesh_.normals.push_back(normal);
    if (!mesh_.uvs.empty()) {
      const Vec2 uv = mesh_.uvs[vertex];
      mesh_.uvs.push_back(uv);
    }
    previous_.push_back(newest_[vertex]);
    newest_[vertex] = static_cast<std::uint32_t>(index);
    return newest_[vertex];
  }

  Mesh& mesh_;
  std::vector<bool> settled_;
  std::vector<std::uint32_t> previous_, newest_;
};

}  // namespace

void add_missing_normals(Mesh& mesh, const std::vector<bool>& has_normal) {
  const std::vector<Vec3> corners = corner_normals(mesh);
  mesh.normals.resize(mesh.positions.size(), Vec3{0, 0, 1});
  VertexSplitter splitter(mesh, has_normal);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    std::uint32_t& vertex = mesh.triangles[c / 3][c % 3];
    if (vertex < has_normal.size() && has_normal[vertex]) continue;
    vertex = splitter.vertex_with(vertex, corners[c]);
  }
}

}  // namespace raysheaf::io
