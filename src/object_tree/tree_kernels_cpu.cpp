#include "base/vec.h"
#include "object_tree/float4.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/triangle_reader.h"

namespace raysheaf {
namespace {

/// Prefetch distances in triangles: indices, then the corners to which they refer.
constexpr std::uint32_t kIndexAhead = 32, kCornerAhead = 16;

/// Writes quads and boxes of leaves whose i-th triangle is `fetch(i, &id)`.
template <class Fetch>
void write_all(const std::uint8_t* sizes, std::uint32_t leaf_count, TriangleQuad* quads,
               AreaItem* boxes, const Fetch& fetch) {
  std::uint32_t place = 0;
  for (std::uint32_t leaf = 0; leaf < leaf_count; ++leaf) {
    const std::uint32_t size = sizes[leaf];
    TriangleQuad* quad = quads + leaf;
    LoadedTriangle t[4];
    t[0] = fetch(place, &quad->id[0]);
    for (std::uint32_t i = 1; i < 4; ++i) {
      if (i < size) {
        t[i] = fetch(place + i, &quad->id[i]);
      } else {
        t[i] = t[0];
        quad->id[i] = quad->id[0];
      }
    }
    place += size;
    Float4 low = t[0].corner[0], high = low;
    for (const LoadedTriangle& triangle : t)
      for (const Float4 p : triangle.corner) low = min(low, p), high = max(high, p);
    store_quad(t, quad);
    store4(low, &boxes[leaf].min.x);
    store4(high, &boxes[leaf].max.x);
    boxes[leaf].weight = size;
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
    const TriangleReader::Corners c = reader.corners(id);
    sorted[to] = (key & ~id_mask) | to;
    records[to] = {{*c.p[0], *c.p[1], *c.p[2]}, id};
  }
}

void write_leaves(const TriangleSource& source, const TriangleRecord* records,
                  const std::uint64_t* sorted, std::uint32_t id_bits, const std::uint8_t* sizes,
                  std::uint32_t leaf_count, TriangleQuad* quads, AreaItem* boxes) {
  const std::uint64_t id_mask = (std::uint64_t{1} << id_bits) - 1;
  const auto low_bits = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>(sorted[i] & id_mask);
  };
  std::uint32_t total = 0;
  for (std::uint32_t leaf = 0; leaf < leaf_count; ++leaf) total += sizes[leaf];
  if (records != nullptr)
    return write_all(sizes, leaf_count, quads, boxes, [&](std::uint32_t i, std::uint32_t* id) {
      if (i + kCornerAhead < total)
        __builtin_prefetch(&records[low_bits(i + kCornerAhead)].corner[2]);
      const TriangleRecord& record = records[low_bits(i)];
      *id = record.id;
      return load_corners({{&record.corner[0], &record.corner[1], &record.corner[2]}});
    });
  TriangleReader reader(source);
  write_all(sizes, leaf_count, quads, boxes, [&](std::uint32_t i, std::uint32_t* id) {
    if (i + kIndexAhead < total) reader.prefetch_index(low_bits(i + kIndexAhead));
    if (i + kCornerAhead < total) reader.prefetch_corners(low_bits(i + kCornerAhead));
    *id = low_bits(i);
    return load_corners(reader.corners(*id));
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
