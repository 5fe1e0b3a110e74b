// Reads the corners of triangles by number, for quads.
#pragma once

#include "intersect/triangle_body.h"
#include "object_tree/float4.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

struct CornerPointers {
  const Vec3* p[3];
};
/// Triangle i of a run.
inline CornerPointers corners_of(const TriangleRun& run, std::uint32_t i) {
  if (run.triangles == nullptr) {
    const Vec3* p = run.positions + std::size_t{3} * i;
    return {{p, p + 1, p + 2}};
  }
  const auto& t = run.triangles[i];
  return {{run.positions + t[0], run.positions + t[1], run.positions + t[2]}};
}

/// Finds triangles' corners; remembers the run of the last triangle.
class TriangleReader {
 public:
  explicit TriangleReader(const TriangleSource& source) : source_(source), run_(source.runs.data) {}

  CornerPointers corners(std::uint32_t id) {
    if (id - run_->first >= run_->count) run_ = &source_.runs[source_.run_of(id)];
    return corners_of(*run_, id - run_->first);
  }
  /// Prefetches the indices, if the triangle is in the last triangle's run.
  void prefetch_index(std::uint32_t id) const {
    const std::uint32_t i = id - run_->first;
    if (i < run_->count && run_->triangles != nullptr) __builtin_prefetch(&run_->triangles[i]);
  }
  /// Prefetches the corners; reads the indices.
  void prefetch_corners(std::uint32_t id) const {
    const std::uint32_t i = id - run_->first;
    if (i >= run_->count) return;
    const CornerPointers c = corners_of(*run_, i);
    for (const Vec3* p : c.p) __builtin_prefetch(p);
  }

 private:
  const TriangleSource& source_;
  const TriangleRun* run_;
};

struct LoadedTriangle {
  Float4 corner[3];
};

inline LoadedTriangle load_corners(const CornerPointers& c) {
  return {{load3(*c.p[0]), load3(*c.p[1]), load3(*c.p[2])}};
}

/// The extents of the boxes of a quad's triangles.
struct QuadExtents {
  Float4 axis[3];

  explicit QuadExtents(const TriangleQuad& quad) {
    for (int i = 0; i < 3; ++i) {
      const Float4 a = load4(quad.vertex[0][i]), b = load4(quad.vertex[1][i]);
      const Float4 c = load4(quad.vertex[2][i]);
      axis[i] = max(max(a, b), c) - min(min(a, b), c);
    }
  }
  [[nodiscard]] Float4 surfaces() const {
    return axis[0] * axis[1] + axis[1] * axis[2] + axis[2] * axis[0];
  }
  /// `reach_of_extent` of the triangles.
  void store_reach(TriangleQuad* quad) const {
    const Float4 most = max(max(max(all4(0), axis[0]), axis[1]), axis[2]);
    store4(where_within(most, kLeastReachExtent, kMostReachExtent, most * all4(kReachOfExtent)),
           quad->reach);
  }
};

inline QuadExtents store_quad(const LoadedTriangle (&t)[4], TriangleQuad* quad) {
  for (int k = 0; k < 3; ++k)
    store_columns(t[0].corner[k], t[1].corner[k], t[2].corner[k], t[3].corner[k], quad->vertex[k]);
  const QuadExtents extents(*quad);
  extents.store_reach(quad);
  return extents;
}

/// Bit i: whether p[i] and q[i] certainly differ although they are rounded products, as in
/// tree_kernels_simd.cpp.
inline unsigned surely_differ(Float4 p, Float4 q) {
  return greater_lanes(abs(p - q), all4(0x1p-20f) * (abs(p) + abs(q)) + all4(0x1p-100f));
}
/// Whether all triangles of a quad certainly have an area.
inline bool surely_have_area(const TriangleQuad& quad) {
  Float4 u[3], v[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Float4 a = load4(quad.vertex[0][axis]);
    u[axis] = load4(quad.vertex[1][axis]) - a;
    v[axis] = load4(quad.vertex[2][axis]) - a;
  }
  return (surely_differ(u[1] * v[2], u[2] * v[1]) | surely_differ(u[2] * v[0], u[0] * v[2]) |
          surely_differ(u[0] * v[1], u[1] * v[0])) == 0xf;
}

}  // namespace raysheaf
