// Computes normals for meshes without normals that may be larger than memory:
//
//   triangles ─► corners, sorted by (position, number) ─► runs of one position ─► their normals,
//   sorted by number ─► vertices are split, as in memory
#include <array>

#include "io/corner_normals.h"
#include "io/outer_mesh.h"
#include "io/outer_sort.h"

namespace raysheaf::io {
namespace {

/// A corner, with its whole triangle.
struct OuterCorner {
  std::array<Vec3, 3> at;
  std::uint32_t triangle, corner;

  [[nodiscard]] std::array<float, 3> position() const {
    return {at[corner].x, at[corner].y, at[corner].z};
  }
};
struct ByPosition {
  bool operator()(const OuterCorner& a, const OuterCorner& b) const {
    const auto p = a.position(), q = b.position();
    if (p != q) return p < q;
    return a.triangle != b.triangle ? a.triangle < b.triangle : a.corner < b.corner;
  }
};

struct CornerNormal {
  std::uint32_t triangle, corner;
  Vec3 normal;
};
struct ByCorner {
  bool operator()(const CornerNormal& a, const CornerNormal& b) const {
    return a.triangle != b.triangle ? a.triangle < b.triangle : a.corner < b.corner;
  }
};

using SortedCorners = OuterSort<OuterCorner, ByPosition>;
using SortedNormals = OuterSort<CornerNormal, ByCorner>;

/// The corners at one position.
class OuterRun {
 public:
  explicit OuterRun(SortedNormals* to) : to_(*to) {}

  void add(const OuterCorner& corner) {
    const bool same = count_ > 0 && corners_[count_ - 1].position() == corner.position();
    if (!same || count_ == corners_.size()) end();
    faces_[count_] = face_normal(corner.at[0], corner.at[1], corner.at[2]);
    corners_[count_++] = corner;
  }
  void end() {
    smooth_run({faces_.data(), count_}, {kSmoothing.data(), count_}, {normals_.data(), count_});
    for (std::size_t i = 0; i < count_; ++i)
      to_.add({corners_[i].triangle, corners_[i].corner, normals_[i]});
    count_ = 0;
  }

 private:
  static constexpr auto kSmoothing = [] {
    std::array<std::uint32_t, kMaxFacesAtPosition> all{};
    all.fill(kByAngle);
    return all;
  }();

  SortedNormals& to_;
  std::array<OuterCorner, kMaxFacesAtPosition> corners_;
  std::array<Double3, kMaxFacesAtPosition> faces_;
  std::array<Vec3, kMaxFacesAtPosition> normals_;
  std::size_t count_ = 0;
};

void sort_corners(const OuterMesh& mesh, SortedCorners* corners) {
  for (std::uint64_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto triangle = mesh.triangles[t];
    OuterCorner corner{};
    corner.triangle = static_cast<std::uint32_t>(t);
    for (std::size_t k = 0; k < 3; ++k) corner.at[k] = mesh.positions[triangle[k]];
    for (; corner.corner < 3; ++corner.corner) corners->add(corner);
  }
}

bool has_length(Vec3 normal) {
  return normal.x != 0 || normal.y != 0 || normal.z != 0;
}

}  // namespace

void add_missing_normals(OuterMesh& mesh, const PackOptions& options) {
  const std::size_t held = options.triangles_at_once;
  SortedNormals normals(options.beside, held);
  {
    SortedCorners corners(options.beside, held);
    sort_corners(mesh, &corners);
    OuterRun run(&normals);
    corners.for_each([&](const OuterCorner& corner) { run.add(corner); });
    run.end();
  }
  mesh.normals.resize(mesh.positions.size());
  OuterArray<std::uint32_t> newest(options.beside, held / 4), previous(options.beside, held / 4);
  VertexSplitter splitter(mesh, newest, previous);
  normals.for_each([&](const CornerNormal& corner) {
    auto triangle = mesh.triangles[corner.triangle];
    std::uint32_t& vertex = triangle[corner.corner];
    if (!splitter.is_settled(vertex) && has_length(mesh.normals[vertex])) return;
    vertex = splitter.vertex_with(vertex, corner.normal);
    mesh.triangles.set(corner.triangle, triangle);
  });
}

}  // namespace raysheaf::io
