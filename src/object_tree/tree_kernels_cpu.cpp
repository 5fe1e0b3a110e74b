#include <algorithm>
#include <limits>
#include <utility>

#include "base/vec.h"
#include "object_tree/float4.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/triangle_reader.h"

namespace raysheaf {
namespace {

/// Prefetch distances in triangles: indices, then the corners to which they refer.
constexpr std::uint32_t kIndexAhead = 32, kCornerAhead = 16;
/// The same in strips.
constexpr std::uint32_t kStripIndexAhead = 16, kStripCornerAhead = 6;

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
    const CornerPointers c = reader.corners(id);
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
