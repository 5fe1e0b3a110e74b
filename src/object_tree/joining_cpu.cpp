// Joins triangles that follow each other in the source: into strips, or into leaves whose quads
// stay in the order of the source.
#include <algorithm>
#include <limits>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/float4.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/triangle_reader.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// A triangle joins a strip if the surface of their common box is at most this multiple of the sum
/// of their boxes' surfaces.
constexpr float kMostGrowth = 1.2f;
/// The same for a quad that joins a leaf, with the sum over all quads.
constexpr float kMostLeafGrowth = 1.5f;
/// The same for four triangles that become a quad.
constexpr float kMostQuadGrowth = 1;

/// x y + y z + z x of the extents of a box.
float surface_of(Float4 low, Float4 high) {
  const Float4 size = high - low;
  return sum3(size * yzx(size));
}

/// Whether a component of the cross product certainly is not zero.
bool surely_has_area(const LoadedTriangle& t) {
  const Float4 u = t.corner[1] - t.corner[0], v = t.corner[2] - t.corner[0];
  return surely_differ(u * yzx(v), yzx(u) * v) != 0;
}

/// Writes the doubled centres of boxes, one after the other.
class CenterWriter {
 public:
  CenterWriter(CenterColumns centers, std::uint32_t first) : centers_(centers), next_(first) {}

  void add(Float4 low, Float4 high) {
    const Float4 center = low + high;
    alignas(16) float c[4];
    store4(center, c);
    for (int axis = 0; axis < 3; ++axis) centers_.axis[axis][next_] = c[axis];
    ++next_;
    least_ = min(least_, center);
    most_ = max(most_, center);
  }
  /// Where the next one is written.
  [[nodiscard]] std::uint32_t next() const { return next_; }
  /// The box of the centres.
  [[nodiscard]] Box bounds() const {
    alignas(16) float low[4], high[4];
    store4(least_, low);
    store4(most_, high);
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }

 private:
  CenterColumns centers_;
  std::uint32_t next_;
  Float4 least_ = all4(std::numeric_limits<float>::infinity());
  Float4 most_ = all4(-std::numeric_limits<float>::infinity());
};

/// Joins triangles that come one after the other.
class StripJoiner {
 public:
  StripJoiner(CenterColumns centers, std::uint32_t* strips)
      : centers_(centers, 0), strips_(strips) {}

  void add(const LoadedTriangle& t, std::uint32_t id) {
    const Float4 low = min(min(t.corner[0], t.corner[1]), t.corner[2]);
    const Float4 high = max(max(t.corner[0], t.corner[1]), t.corner[2]);
    const float surface = surface_of(low, high);
    if (size_ != 0) {
      const Float4 joined_low = min(low_, low), joined_high = max(high_, high);
      const float joined = surface_of(joined_low, joined_high);
      if (size_ < kQuadTriangles && joined <= kMostGrowth * (surface_ + surface)) {
        low_ = joined_low;
        high_ = joined_high;
        surface_ = joined;
        ++size_;
        return;
      }
      close();
    }
    low_ = low;
    high_ = high;
    surface_ = surface;
    first_ = id;
    size_ = 1;
  }
  /// Ends the current strip.
  void close() {
    if (size_ == 0) return;
    strips_[centers_.next()] = first_ << kStripBits | (size_ - 1);
    centers_.add(low_, high_);
    size_ = 0;
  }

  [[nodiscard]] std::uint32_t count() const { return centers_.next(); }
  [[nodiscard]] Box bounds() const { return centers_.bounds(); }

 private:
  CenterWriter centers_;
  std::uint32_t* strips_;
  std::uint32_t first_ = 0, size_ = 0;
  Float4 low_ = all4(0), high_ = all4(0);
  float surface_ = 0;
};

/// Joins quads that come one after the other into leaves.
class LeafJoiner {
 public:
  LeafJoiner(std::uint32_t most_quads, std::uint32_t first, CenterColumns centers, AreaItem* leaves)
      : most_quads_(most_quads), centers_(centers, first), leaves_(leaves) {}

  void add(std::uint32_t quad, std::uint32_t triangles, Float4 low, Float4 high) {
    const float surface = surface_of(low, high);
    const Float4 joined_low = min(low_, low), joined_high = max(high_, high);
    if (quads_ != 0 && quads_ < most_quads_ &&
        surface_of(joined_low, joined_high) <= kMostLeafGrowth * (surface_ + surface)) {
      low_ = joined_low;
      high_ = joined_high;
      surface_ += surface;
      triangles_ += triangles;
      ++quads_;
    } else {
      close();
      first_ = quad;
      low_ = low;
      high_ = high;
      surface_ = surface;
      triangles_ = triangles;
      quads_ = 1;
    }
    // Only a leaf's last quad is not full.
    if (triangles != kQuadTriangles) close();
  }
  /// Ends the current leaf.
  void close() {
    if (quads_ == 0) return;
    AreaItem* const leaf = &leaves_[centers_.next()];
    store4(low_, &leaf->min.x);
    store4(high_, &leaf->max.x);
    leaf->ref = first_;
    leaf->weight = triangles_;
    centers_.add(low_, high_);
    quads_ = 0;
  }
  [[nodiscard]] std::uint32_t next() const { return centers_.next(); }
  [[nodiscard]] Box bounds() const { return centers_.bounds(); }

 private:
  std::uint32_t most_quads_;
  CenterWriter centers_;
  AreaItem* leaves_;
  std::uint32_t first_ = 0, quads_ = 0, triangles_ = 0;
  Float4 low_ = all4(0), high_ = all4(0);
  float surface_ = 0;  ///< of the quads' boxes
};

/// Joins triangles [begin, end) of a run; all of them if `left_out` is null.
void join_part(const TriangleRun& run, std::uint32_t begin, std::uint32_t end, StripJoiner* joiner,
               std::vector<std::uint32_t>* left_out) {
  for (std::uint32_t i = begin; i < end; ++i) {
    const CornerPointers c = corners_of(run, i);
    const LoadedTriangle t = load_corners(c);
    if (left_out == nullptr || surely_has_area(t) || !has_no_area(*c.p[0], *c.p[1], *c.p[2])) {
      joiner->add(t, run.first + i);
    } else {
      joiner->close();
      left_out->push_back(run.first + i);
    }
  }
  joiner->close();
}

/// Four triangles, of which those from `count` on repeat the first, and their box.
struct LoadedQuad {
  LoadedTriangle triangle[kQuadTriangles];
  Float4 low, high;

  LoadedQuad(const TriangleRun& run, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t k = 0; k < kQuadTriangles; ++k)
      triangle[k] = load_corners(corners_of(run, first + (k < count ? k : 0)));
    low = high = triangle[0].corner[0];
    for (const LoadedTriangle& t : triangle)
      for (const Float4 p : t.corner) {
        low = min(low, p);
        high = max(high, p);
      }
  }
};

void set_ids(std::uint32_t first, std::uint32_t count, TriangleQuad* quad) {
  for (std::uint32_t k = 0; k < kQuadTriangles; ++k) quad->id[k] = first + (k < count ? k : 0);
}

/// Writes the quad of a strip, the last of a leaf.
void write_strip(const TriangleRun& run, std::uint32_t strip, std::uint32_t number,
                 TriangleQuad* quads, LeafJoiner* leaves) {
  const std::uint32_t first = strip >> kStripBits, count = strip % (1u << kStripBits) + 1;
  const LoadedQuad loaded(run, first - run.first, count);
  store_quad(loaded.triangle, &quads[number]);
  set_ids(first, count, &quads[number]);
  leaves->add(number, count, loaded.low, loaded.high);
  leaves->close();
}

/// Writes quads of consecutive triangles.
class SourceWriter {
 public:
  SourceWriter(TriangleQuad* quads, bool keep_flat, LeafJoiner* leaves, SourceLeaves* result)
      : quads_(quads),
        left_out_(keep_flat ? nullptr : &result->left_out),
        leaves_(*leaves),
        result_(*result) {}

  /// Writes quad `number` with `count` triangles of a run, from triangle i on.
  void add(const TriangleRun& run, std::uint32_t i, std::uint32_t count, std::uint32_t number) {
    const LoadedQuad loaded(run, i, count);
    TriangleQuad* const quad = &quads_[number];
    const float surfaces = sum4(store_quad(loaded.triangle, quad).surfaces());
    const bool joins = surface_of(loaded.low, loaded.high) <= kMostQuadGrowth * surfaces;
    if (!joins || !surely_have_area(*quad)) return add_strips(run, i, count, number);
    set_ids(run.first + i, count, quad);
    leaves_.add(number, count, loaded.low, loaded.high);
  }

 private:
  /// The same with only the first of the strips into which these triangles are joined.
  void add_strips(const TriangleRun& run, std::uint32_t i, std::uint32_t count,
                  std::uint32_t number) {
    float columns[3][kQuadTriangles];
    std::uint32_t strips[kQuadTriangles];
    StripJoiner joiner({{columns[0], columns[1], columns[2]}}, strips);
    join_part(run, i, i + count, &joiner, left_out_);
    if (joiner.count() == 0) {
      leaves_.close();  // the quads of a leaf are consecutive
      return write_unused(run, i, &quads_[number]);
    }
    write_strip(run, strips[0], number, quads_, &leaves_);
    result_.strips.insert(result_.strips.end(), strips + 1, strips + joiner.count());
  }

  /// A quad that belongs to no leaf: a point, as after a refit.
  static void write_unused(const TriangleRun& run, std::uint32_t i, TriangleQuad* quad) {
    LoadedQuad loaded(run, i, 1);
    for (LoadedTriangle& t : loaded.triangle) t.corner[1] = t.corner[2] = t.corner[0];
    store_quad(loaded.triangle, quad);
    set_ids(run.first + i, 1, quad);
  }

  TriangleQuad* quads_;
  std::vector<std::uint32_t>* left_out_;
  LeafJoiner& leaves_;
  SourceLeaves& result_;
};

}  // namespace

std::uint32_t join_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                             CenterColumns centers, std::uint32_t* strips, Box* bounds,
                             std::vector<std::uint32_t>* left_out) {
  StripJoiner joiner(centers, strips);
  source.for_each_part(begin, end,
                       [&](const TriangleRun& run, std::uint32_t first, std::uint32_t stop) {
                         join_part(run, first, stop, &joiner, left_out);
                       });
  *bounds = joiner.bounds();
  return joiner.count();
}

std::uint32_t count_quads(const TriangleSource& source, std::uint32_t begin, std::uint32_t end) {
  std::uint32_t quads = 0;
  source.for_each_part(begin, end,
                       [&](const TriangleRun& /*run*/, std::uint32_t first, std::uint32_t stop) {
                         quads += div_ceil(stop - first, kQuadTriangles);
                       });
  return quads;
}

void write_source_leaves(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                         std::uint32_t most_quads, bool keep_flat, std::uint32_t first_quad,
                         TriangleQuad* quads, CenterColumns centers, AreaItem* leaves,
                         SourceLeaves* result) {
  LeafJoiner joiner(most_quads, first_quad, centers, leaves);
  SourceWriter writer(quads, keep_flat, &joiner, result);
  std::uint32_t quad = first_quad;
  source.for_each_part(begin, end,
                       [&](const TriangleRun& run, std::uint32_t first, std::uint32_t stop) {
                         for (std::uint32_t i = first; i < stop; i += kQuadTriangles)
                           writer.add(run, i, std::min(stop - i, kQuadTriangles), quad++);
                         joiner.close();
                       });
  result->count = joiner.next() - first_quad;
  result->bounds = joiner.bounds();
}

Box write_strip_leaves(const TriangleSource& source, View<const std::uint32_t> strips,
                       std::uint32_t first_quad, TriangleQuad* quads, CenterColumns centers,
                       AreaItem* leaves) {
  LeafJoiner joiner(1, first_quad, centers, leaves);
  const TriangleRun* run = source.runs.data;
  for (const std::uint32_t strip : strips) {
    const std::uint32_t first = strip >> kStripBits;
    if (first - run->first >= run->count) run = &source.runs[source.run_of(first)];
    write_strip(*run, strip, joiner.next(), quads, &joiner);
  }
  return joiner.bounds();
}

}  // namespace raysheaf
