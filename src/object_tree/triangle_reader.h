// Reads the corners of triangles by number, for quads.
#pragma once

#include "intersect/triangle_body.h"
#include "object_tree/float4.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

struct Corners {
  const Vec3* p[3];
};
/// Triangle i of a run.
inline Corners corners_of(const TriangleRun& run, std::uint32_t i) {
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

  Corners corners(std::uint32_t id) {
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
    const Corners c = corners_of(*run_, i);
    for (const Vec3* p : c.p) __builtin_prefetch(p);
  }

 private:
  const TriangleSource& source_;
  const TriangleRun* run_;
};

struct LoadedTriangle {
  Float4 corner[3];
};

inline LoadedTriangle load_corners(const Corners& c) {
  return {{load3(*c.p[0]), load3(*c.p[1]), load3(*c.p[2])}};
}

/// Stores `reach_of_extent` of a quad's triangles.
inline void store_reach(TriangleQuad* quad) {
  Float4 extent = all4(0);
  for (int axis = 0; axis < 3; ++axis) {
    const Float4 a = load4(quad->vertex[0][axis]), b = load4(quad->vertex[1][axis]);
    const Float4 c = load4(quad->vertex[2][axis]);
    extent = max(extent, max(max(a, b), c) - min(min(a, b), c));
  }
  store4(where_within(extent, kLeastReachExtent, kMostReachExtent, extent * all4(kReachOfExtent)),
         quad->reach);
}

inline void store_quad(const LoadedTriangle (&t)[4], TriangleQuad* quad) {
  for (int k = 0; k < 3; ++k)
    store_columns(t[0].corner[k], t[1].corner[k], t[2].corner[k], t[3].corner[k], quad->vertex[k]);
  store_reach(quad);
}

}  // namespace raysheaf
