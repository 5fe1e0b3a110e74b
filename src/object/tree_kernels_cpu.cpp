#include "base/vec.h"
#include "object/float4.h"
#include "object/tree_kernels.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// How far ahead, in triangles, memory is asked for: indices, then the corners that they name.
constexpr std::uint32_t kIndexAhead = 32, kCornerAhead = 16;

struct Corners {
  const Vec3* p[3];
};

/// Finds triangles' corners; remembers the run of the last.
class Reader {
 public:
  explicit Reader(const TriangleSource& source) : source_(source), run_(&source.runs[0]) {}

  Corners corners(std::uint32_t id) {
    if (id - run_->first >= run_->count) run_ = &source_.runs[source_.run_of(id)];
    return corners_in_run(id - run_->first);
  }
  void prefetch_index(std::uint32_t id) const {
    const std::uint32_t i = id - run_->first;
    if (i < run_->count && run_->triangles != nullptr) __builtin_prefetch(&run_->triangles[i]);
  }
  void prefetch_corners(std::uint32_t id) const {
    const std::uint32_t i = id - run_->first;
    if (i >= run_->count) return;
    const Corners c = corners_in_run(i);
    for (const Vec3* p : c.p) __builtin_prefetch(p);
  }

 private:
  [[nodiscard]] Corners corners_in_run(std::uint32_t i) const {
    if (run_->triangles == nullptr)
      return {{run_->positions + 3 * i, run_->positions + 3 * i + 1, run_->positions + 3 * i + 2}};
    const auto& t = run_->triangles[i];
    return {{run_->positions + t[0], run_->positions + t[1], run_->positions + t[2]}};
  }

  const TriangleSource& source_;
  const TriangleRun* run_;
};

struct Loaded {
  Float4 corner[3];
};

Loaded load(const Corners& c) {
  return {{load3(*c.p[0]), load3(*c.p[1]), load3(*c.p[2])}};
}

void store(const Loaded (&t)[4], TriangleQuad* quad) {
  for (int k = 0; k < 3; ++k)
    store_columns(t[0].corner[k], t[1].corner[k], t[2].corner[k], t[3].corner[k], quad->vertex[k]);
}

/// Quads and boxes of leaves whose i-th triangle is `fetch(i, &id)`.
template <class Fetch>
void write_all(const std::uint8_t* sizes, std::uint32_t leaf_count, TriangleQuad* quads,
               AreaItem* boxes, const Fetch& fetch) {
  std::uint32_t place = 0;
  for (std::uint32_t leaf = 0; leaf < leaf_count; ++leaf) {
    const std::uint32_t size = sizes[leaf];
    TriangleQuad* quad = quads + leaf;
    Loaded t[4];
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
    for (const Loaded& triangle : t)
      for (const Float4 p : triangle.corner) low = min(low, p), high = max(high, p);
    store(t, quad);
    store4(low, &boxes[leaf].min.x);
    store4(high, &boxes[leaf].max.x);
    boxes[leaf].weight = size;
  }
}

/// Makes points of triangles that have no area.
void flatten(TriangleQuad* quad) {
  for (int lane = 0; lane < 4; ++lane) {
    Vec3 p[3];
    for (int k = 0; k < 3; ++k)
      p[k] = {quad->vertex[k][0][lane], quad->vertex[k][1][lane], quad->vertex[k][2][lane]};
    if (!has_no_area(p[0], p[1], p[2])) continue;
    for (int k = 1; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        quad->vertex[k][axis][lane] = quad->vertex[0][axis][lane];
  }
}

}  // namespace

void scatter_keys(const TriangleSource& source, View<const std::uint64_t> keys, const Curve& curve,
                  std::uint32_t bucket_shift, std::uint32_t* place, std::uint64_t* sorted,
                  TriangleRecord* records) {
  const std::uint32_t shift = curve.id_bits + bucket_shift;
  if (records == nullptr) {
    for (const std::uint64_t key : keys) sorted[place[key >> shift]++] = key;
    return;
  }
  const std::uint64_t id_mask = (std::uint64_t{1} << curve.id_bits) - 1;
  Reader reader(source);
  for (const std::uint64_t key : keys) {
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
  if (records != nullptr)
    return write_all(sizes, leaf_count, quads, boxes, [&](std::uint32_t i, std::uint32_t* id) {
      const TriangleRecord& record = records[low_bits(i)];
      *id = record.id;
      return load({{&record.corner[0], &record.corner[1], &record.corner[2]}});
    });
  std::uint32_t total = 0;
  for (std::uint32_t leaf = 0; leaf < leaf_count; ++leaf) total += sizes[leaf];
  Reader reader(source);
  write_all(sizes, leaf_count, quads, boxes, [&](std::uint32_t i, std::uint32_t* id) {
    if (i + kIndexAhead < total) reader.prefetch_index(low_bits(i + kIndexAhead));
    if (i + kCornerAhead < total) reader.prefetch_corners(low_bits(i + kCornerAhead));
    *id = low_bits(i);
    return load(reader.corners(*id));
  });
}

void refill_quads(const TriangleSource& source, std::uint32_t count, TriangleQuad* quads) {
  constexpr std::uint32_t kIndexQuads = kIndexAhead / 4, kCornerQuads = kCornerAhead / 4;
  Reader reader(source);
  for (std::uint32_t q = 0; q < count; ++q) {
    if (q + kIndexQuads < count)
      for (const std::uint32_t id : quads[q + kIndexQuads].id) reader.prefetch_index(id);
    if (q + kCornerQuads < count)
      for (const std::uint32_t id : quads[q + kCornerQuads].id) reader.prefetch_corners(id);
    Loaded t[4];
    for (int i = 0; i < 4; ++i) t[i] = load(reader.corners(quads[q].id[i]));
    store(t, &quads[q]);
    flatten(&quads[q]);
  }
}

void quad_box(const TriangleQuad& quad, Box* box) {
  float low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Float4 a = load4(quad.vertex[0][axis]), b = load4(quad.vertex[1][axis]),
                 c = load4(quad.vertex[2][axis]);
    low[axis] = lowest(min(min(a, b), c));
    high[axis] = highest(max(max(a, b), c));
  }
  *box = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
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
