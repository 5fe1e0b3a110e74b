#include <algorithm>
#include <limits>
#include <utility>

#include "base/vec.h"
#include "object_tree/float4.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/triangle_reader.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// Prefetch distances in triangles: indices, then the corners to which they refer.
constexpr std::uint32_t kIndexAhead = 32, kCornerAhead = 16;
/// The same in strips.
constexpr std::uint32_t kStripIndexAhead = 16, kStripCornerAhead = 6;

/// A triangle joins a strip if the surface of their common box is at most this multiple of the sum
/// of their boxes' surfaces.
constexpr float kMostGrowth = 1.2f;

/// Writes the quads of one leaf after the other.
class LeafWriter {
 public:
  LeafWriter(TriangleQuad* quads, std::uint32_t first_quad, AreaItem* boxes)
      : quads_(quads), leaf_(first_quad), quad_(first_quad), box_(boxes) {}

  void add(const LoadedTriangle& t, std::uint32_t id) {
    if (lane_ == kQuadTriangles) close_quad();
    triangles_[lane_] = t;
    quads_[quad_].id[lane_++] = id;
    low_ = min(min(low_, t.corner[0]), min(t.corner[1], t.corner[2]));
    high_ = max(max(high_, t.corner[0]), max(t.corner[1], t.corner[2]));
    ++size_;
  }

  /// Ends the current leaf, which has triangles.
  void close() {
    for (; lane_ < kQuadTriangles; ++lane_) {
      triangles_[lane_] = triangles_[0];
      quads_[quad_].id[lane_] = quads_[quad_].id[0];
    }
    close_quad();
    store4(low_, &box_->min.x);
    store4(high_, &box_->max.x);
    box_->ref = std::exchange(leaf_, quad_);
    box_->weight = std::exchange(size_, 0);
    ++box_;
    low_ = all4(kFar);
    high_ = all4(-kFar);
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  void close_quad() {
    store_quad(triangles_, &quads_[quad_++]);
    lane_ = 0;
  }

  TriangleQuad* quads_;
  std::uint32_t leaf_, quad_;  ///< the first quad of the leaf, and the current one
  AreaItem* box_;
  LoadedTriangle triangles_[kQuadTriangles];
  std::uint32_t lane_ = 0, size_ = 0;
  Float4 low_ = all4(kFar), high_ = all4(-kFar);
};

/// x y + y z + z x of the extents of a box.
float surface_of(Float4 low, Float4 high) {
  const Float4 size = high - low;
  return sum3(size * yzx(size));
}

/// Whether one of the first three components certainly is not zero; as in tree_kernels_simd.cpp.
bool surely_has_area(const LoadedTriangle& t) {
  const Float4 u = t.corner[1] - t.corner[0], v = t.corner[2] - t.corner[0];
  const Float4 p = u * yzx(v), q = yzx(u) * v;
  return greater_lanes(abs(p - q), all4(0x1p-20f) * (abs(p) + abs(q)) + all4(0x1p-100f)) != 0;
}

/// Joins triangles that come one after the other.
class StripJoiner {
 public:
  StripJoiner(CenterColumns centers, std::uint32_t* strips) : centers_(centers), strips_(strips) {}

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
    const Float4 center = low_ + high_;
    alignas(16) float c[4];
    store4(center, c);
    for (int axis = 0; axis < 3; ++axis) centers_.axis[axis][count_] = c[axis];
    strips_[count_++] = first_ << kStripBits | (size_ - 1);
    least_ = min(least_, center);
    most_ = max(most_, center);
    size_ = 0;
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// The box of the centres.
  [[nodiscard]] Box bounds() const {
    alignas(16) float low[4], high[4];
    store4(least_, low);
    store4(most_, high);
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }

 private:
  CenterColumns centers_;
  std::uint32_t* strips_;
  std::uint32_t count_ = 0, first_ = 0, size_ = 0;
  Float4 low_ = all4(0), high_ = all4(0);
  float surface_ = 0;
  Float4 least_ = all4(std::numeric_limits<float>::infinity());
  Float4 most_ = all4(-std::numeric_limits<float>::infinity());
};

/// Calls `add(i, end)` for the items of leaves, `end` in total, and closes each leaf.
template <class Add>
void for_each_item(const LeafItems& leaves, LeafWriter* writer, const Add& add) {
  std::uint32_t end = 0;
  for (std::uint32_t leaf = 0; leaf < leaves.leaf_count; ++leaf) end += leaves.sizes[leaf];
  std::uint32_t i = 0;
  for (std::uint32_t leaf = 0; leaf < leaves.leaf_count; ++leaf) {
    for (const std::uint32_t after = i + leaves.sizes[leaf]; i < after; ++i) add(i, end);
    writer->close();
  }
}

}  // namespace

std::uint32_t join_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                             CenterColumns centers, std::uint32_t* strips, Box* bounds,
                             std::vector<std::uint32_t>* left_out) {
  StripJoiner joiner(centers, strips);
  source.for_each_part(begin, end,
                       [&](const TriangleRun& run, std::uint32_t first, std::uint32_t stop) {
                         for (std::uint32_t i = first; i < stop; ++i) {
                           const Corners c = corners_of(run, i);
                           const LoadedTriangle t = load_corners(c);
                           if (surely_has_area(t) || !has_no_area(*c.p[0], *c.p[1], *c.p[2])) {
                             joiner.add(t, run.first + i);
                           } else {
                             joiner.close();
                             left_out->push_back(run.first + i);
                           }
                         }
                         joiner.close();
                       });
  *bounds = joiner.bounds();
  return joiner.count();
}

void scatter_keys(const TriangleSource& source, View<const std::uint64_t> keys,
                  const MortonCurve& curve, std::uint32_t bucket_shift, std::uint32_t* place,
                  std::uint64_t* sorted, TriangleRecord* records) {
  const std::uint32_t shift = curve.id_bits + bucket_shift;
  if (records == nullptr) {
    for (const std::uint64_t key : keys) sorted[place[key >> shift]++] = key;
    return;
  }
  const std::uint64_t id_mask = (std::uint64_t{1} << curve.id_bits) - 1;
  TriangleReader reader(source);
  for (std::size_t i = 0; i < keys.size; ++i) {
    if (i + kCornerAhead < keys.size) {
      const std::uint32_t next = place[keys[i + kCornerAhead] >> shift];
      __builtin_prefetch(&records[next], 1);
      __builtin_prefetch(&records[next].id, 1);
      __builtin_prefetch(&sorted[next], 1);
    }
    const std::uint64_t key = keys[i];
    const auto id = static_cast<std::uint32_t>(key & id_mask);
    const std::uint32_t to = place[key >> shift]++;
    const Corners c = reader.corners(id);
    sorted[to] = (key & ~id_mask) | to;
    records[to] = {{*c.p[0], *c.p[1], *c.p[2]}, id};
  }
}

void write_leaves(const TriangleSource& source, const TriangleRecord* records,
                  const LeafItems& leaves, std::uint32_t first_quad, TriangleQuad* quads,
                  AreaItem* boxes) {
  LeafWriter writer(quads, first_quad, boxes);
  TriangleReader reader(source);
  for_each_item(leaves, &writer, [&](std::uint32_t i, std::uint32_t end) {
    const std::uint32_t item = leaves.item(i);
    if (records != nullptr) {
      if (i + kCornerAhead < end)
        __builtin_prefetch(&records[leaves.item(i + kCornerAhead)].corner[2]);
      const Vec3(&corner)[3] = records[item].corner;
      return writer.add(load_corners({{&corner[0], &corner[1], &corner[2]}}), records[item].id);
    }
    if (i + kIndexAhead < end) reader.prefetch_index(leaves.item(i + kIndexAhead));
    if (i + kCornerAhead < end) reader.prefetch_corners(leaves.item(i + kCornerAhead));
    writer.add(load_corners(reader.corners(item)), item);
  });
}

void write_leaves_of_strips(const TriangleSource& source, const LeafItems& leaves,
                            std::uint32_t first_quad, TriangleQuad* quads, AreaItem* boxes) {
  LeafWriter writer(quads, first_quad, boxes);
  TriangleReader reader(source);
  for_each_item(leaves, &writer, [&](std::uint32_t i, std::uint32_t end) {
    if (i + kStripIndexAhead < end)
      reader.prefetch_index(leaves.item(i + kStripIndexAhead) >> kStripBits);
    if (i + kStripCornerAhead < end) {
      const std::uint32_t ahead = leaves.item(i + kStripCornerAhead);
      reader.prefetch_corners(ahead >> kStripBits);
      reader.prefetch_corners((ahead >> kStripBits) + ahead % (1u << kStripBits));
    }
    const std::uint32_t strip = leaves.item(i), first = strip >> kStripBits;
    for (std::uint32_t id = first; id <= first + strip % (1u << kStripBits); ++id)
      writer.add(load_corners(reader.corners(id)), id);
  });
}

void node_box(const BvhNode& node, Box* box) {
  float low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float *min_row = node.bound[axis], *max_row = node.bound[3 + axis];
    low[axis] = lowest(min(load4(min_row), load4(min_row + 4)));
    high[axis] = highest(max(load4(max_row), load4(max_row + 4)));
  }
  *box = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

}  // namespace raysheaf
