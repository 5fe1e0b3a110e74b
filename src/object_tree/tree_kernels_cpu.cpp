#include <algorithm>
#include <limits>

#include "base/vec.h"
#include "object_tree/float4.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/triangle_reader.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// Prefetch distances in triangles: indices, then the corners to which they refer.
constexpr std::uint32_t kIndexAhead = 32, kCornerAhead = 16;

/// A triangle joins a strip if the surface of their common box is at most this multiple of the sum
/// of their boxes' surfaces.
constexpr float kMostGrowth = 1.2f;

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

void write_leaves_of_strips(const TriangleSource& source, const std::uint64_t* sorted,
                            std::uint32_t id_bits, const std::uint8_t* sizes,
                            std::uint32_t leaf_count, TriangleQuad* quads, AreaItem* boxes) {
  constexpr std::uint32_t kLeavesAtOnce = 64;
  const std::uint64_t mask = (std::uint64_t{1} << id_bits) - 1;
  TriangleReader reader(source);
  std::uint32_t ids[kLeavesAtOnce * kQuadTriangles];
  std::uint8_t triangles[kLeavesAtOnce];
  for (std::uint32_t leaf = 0; leaf < leaf_count; leaf += kLeavesAtOnce) {
    const std::uint32_t count = std::min(kLeavesAtOnce, leaf_count - leaf);
    std::uint32_t total = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t before = total;
      for (std::uint32_t i = 0; i < sizes[leaf + k]; ++i) {
        const auto strip = static_cast<std::uint32_t>(*sorted++ & mask);
        reader.prefetch_index(strip >> kStripBits);
        for (std::uint32_t t = 0; t <= strip % (1u << kStripBits); ++t)
          ids[total++] = (strip >> kStripBits) + t;
      }
      triangles[k] = static_cast<std::uint8_t>(total - before);
    }
    write_all(triangles, count, quads + leaf, boxes + leaf,
              [&](std::uint32_t i, std::uint32_t* id) {
                if (i + kCornerAhead < total) reader.prefetch_corners(ids[i + kCornerAhead]);
                *id = ids[i];
                return load_corners(reader.corners(*id));
              });
  }
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
