// Tests triangles with faces, cells of the grids, groups and tiles. Compiled once for each SIMD
// target and chosen at run time (Google Highway).
//
// Faces. Each of the six has a rectangle around its rays. A triangle is rejected if all its
// corners, sheared by either end of the rectangle, are on one side of it, and therefore by every
// ray in between. That also holds for corners behind the origin. Exact arithmetic decides what a
// ray hits, and here x, z, the slope s, the product and the difference of x - s z are rounded once
// each: with |s| <= 1 by at most u (2 |x| + 4 |z|). kBesidePad is more. A triangle is also rejected
// if it is entirely behind the origin, or beyond the farthest ray.
#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fan/stream_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "methods/fan/overlap-inl.h"
#include "methods/fan/stream.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {

using Ints = hn::RebindToSigned<Floats>;
using I = hn::Vec<Ints>;

/// The maximum number of grid cells that a rectangle may touch on either axis; with more, a coarser
/// grid is used.
constexpr std::uint32_t kMostCellsAcross = 2;
/// Up to this many tiles are tested one by one; with more, their groups are tested first.
constexpr std::uint32_t kFewTiles = 32;

/// If at least this many of sixteen triangles remain, they are tested together before each is
/// tested.
constexpr int kWorthALook = 4;

/// The distance of a rejected triangle from a face's rectangle, as a fraction of its coordinates.
constexpr float kBesidePad = 8 * kUnitRoundoff;

struct TileRange {
  std::uint32_t first, last;
};

class Stream {
 public:
  Stream(const FanCells& cells, FanBlock* block) : c_(cells), block_(*block) {
    tiles_ = columns(c_.tiles);
    groups_ = columns(c_.groups);
  }

  void sixteen(const TriangleRun& run, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t k = 0; k < kBundleSlots; ++k) {
      const std::array<Vec3, 3> corners = run.corners(first + std::min(k, count - 1));
      for (int i = 0; i < 3; ++i) {
        const Vec3 p = corners[static_cast<std::size_t>(i)] - c_.origin;
        from_origin_[i][0][k] = p.x, from_origin_[i][1][k] = p.y, from_origin_[i][2][k] = p.z;
      }
    }
    const std::uint32_t lanes = (1u << count) - 1;
    for (std::uint32_t f = 0; f < kFanFaces; ++f) {
      if (c_.faces[f].ray_count == 0) continue;
      block_.bound_tests += count;
      if (const std::uint32_t in = face(f) & lanes; in != 0) descend(f, in, run, first);
    }
  }

 private:
  static BoundColumns columns(const FanBounds& b) {
    return {b.u0.data(), b.u1.data(), b.v0.data(), b.v1.data(), b.reach.data(),
            b.u0.data(), b.u1.data(), b.v0.data(), b.v1.data()};
  }

  HWY_INLINE void load(const FanFace& axes, std::size_t k, V x[3], V y[3], V z[3]) const {
    const Floats d;
    for (int i = 0; i < 3; ++i) {
      x[i] = hn::Load(d, from_origin_[i][axes.x] + k);
      y[i] = hn::Load(d, from_origin_[i][axes.y] + k);
      z[i] = hn::Load(d, from_origin_[i][axes.z] + k);
    }
  }

  /// Whether all corners certainly lie on one side of both ends of [lo, hi].
  static HWY_INLINE M beside(const V x[3], const V z[3], float lo, float hi) {
    const Floats d;
    const V a = hn::Set(d, lo), b = hn::Set(d, hi);
    V l[3], h[3];
    for (int i = 0; i < 3; ++i) {
      l[i] = hn::Sub(x[i], hn::Mul(a, z[i]));
      h[i] = hn::Sub(x[i], hn::Mul(b, z[i]));
    }
    const V size = hn::Add(Max3(hn::Abs(x[0]), hn::Abs(x[1]), hn::Abs(x[2])),
                           Max3(hn::Abs(z[0]), hn::Abs(z[1]), hn::Abs(z[2])));
    const V pad = hn::Add(hn::Mul(hn::Set(d, kBesidePad), size), hn::Set(d, kEdgeTiny));
    return hn::Or(hn::Lt(hn::Max(Max3(l[0], l[1], l[2]), Max3(h[0], h[1], h[2])), hn::Neg(pad)),
                  hn::Gt(hn::Min(Min3(l[0], l[1], l[2]), Min3(h[0], h[1], h[2])), pad));
  }

  /// The lanes that may hit rays of a face; their rectangles go to `lanes_`.
  HWY_INLINE std::uint32_t face(std::uint32_t f) {
    const Floats d;
    const FanFace axes = fan_face(f);
    const FanBound& bound = c_.faces[f].bound;
    std::uint32_t in = 0;
    for (std::size_t k = 0; k < kBundleSlots; k += hn::Lanes(d)) {
      V x[3], y[3], z[3];
      load(axes, k, x, y, z);
      const V side = hn::Set(d, axes.sign);
      const V a = hn::Mul(z[0], side), b = hn::Mul(z[1], side), c = hn::Mul(z[2], side);
      const M behind = hn::Le(Max3(a, b, c), hn::Set(d, -c_.behind));
      const M beyond =
          hn::Gt(hn::Mul(Min3(a, b, c), hn::Set(d, kDepthScale)), hn::Set(d, bound.reach));
      M out = hn::Or(behind, beyond);
      if (hn::AllTrue(d, out)) continue;
      out = hn::Or(out, beside(x, z, bound.u0, bound.u1));
      out = hn::Or(out, beside(y, z, bound.v0, bound.v1));
      if (hn::AllTrue(d, out)) continue;
      MakeRectangles(x, y, z, axes.sign, k, &lanes_);
      find_cells(bound, k);
      in |= BitsOf(hn::Not(out)) << k;
    }
    return in;
  }

  /// Corners of the rectangles on the finest grid, computed like the rays' cells.
  HWY_INLINE void find_cells(const FanBound& bound, std::size_t k) {
    const Floats d;
    const auto half = static_cast<float>(1u << (c_.level - 1));
    const auto last = static_cast<float>((1u << c_.level) - 1);
    const auto cell = [&](const float* from, float lo, float hi, std::int32_t* to) {
      const V c = hn::Min(hn::Max(hn::Load(d, from + k), hn::Set(d, lo)), hn::Set(d, hi));
      const V scaled = hn::Mul(hn::Add(c, hn::Set(d, 1.0f)), hn::Set(d, half));
      const V clamped = hn::Max(hn::Min(scaled, hn::Set(d, last)), hn::Zero(d));
      hn::Store(hn::ConvertTo(Ints(), clamped), Ints(), to + k);
    };
    cell(lanes_.u0, bound.u0, bound.u1, x0_);
    cell(lanes_.u1, bound.u0, bound.u1, x1_);
    cell(lanes_.v0, bound.v0, bound.v1, y0_);
    cell(lanes_.v1, bound.v0, bound.v1, y1_);
  }

  /// Whether no ray of the cells around all of `in` reaches as far as the nearest of them.
  HWY_INLINE bool all_beyond(std::uint32_t f, std::uint32_t in) {
    const Floats d;
    const Ints di;
    constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
    I low_x = hn::Set(di, kMost), low_y = low_x, high_x = hn::Zero(di), high_y = high_x;
    V depth = hn::Set(d, std::numeric_limits<float>::infinity());
    for (std::size_t k = 0; k < kBundleSlots; k += hn::Lanes(d)) {
      const std::uint8_t bits[8] = {static_cast<std::uint8_t>(in >> k),
                                    static_cast<std::uint8_t>(in >> k >> 8)};
      const M some = hn::LoadMaskBits(d, bits);
      const auto some_int = hn::RebindMask(di, some);
      const auto least = [&](I so_far, const std::int32_t* from) {
        return hn::Min(so_far, hn::IfThenElse(some_int, hn::Load(di, from + k), so_far));
      };
      const auto most = [&](I so_far, const std::int32_t* from) {
        return hn::Max(so_far, hn::IfThenElseZero(some_int, hn::Load(di, from + k)));
      };
      low_x = least(low_x, x0_), low_y = least(low_y, y0_);
      high_x = most(high_x, x1_), high_y = most(high_y, y1_);
      depth = hn::Min(depth, hn::IfThenElse(some, hn::Load(d, lanes_.depth + k), depth));
    }
    const auto lane = [](I v) { return static_cast<std::uint32_t>(hn::GetLane(v)); };
    std::uint32_t x0 = lane(hn::MinOfLanes(di, low_x)), x1 = lane(hn::MaxOfLanes(di, high_x));
    std::uint32_t y0 = lane(hn::MinOfLanes(di, low_y)), y1 = lane(hn::MaxOfLanes(di, high_y));
    const float nearest = hn::GetLane(hn::MinOfLanes(d, depth));
    const std::uint32_t level = few_cells(&x0, &x1, &y0, &y1);
    for (std::uint32_t y = y0; y <= y1; ++y) {
      for (std::uint32_t x = x0; x <= x1; ++x) {
        ++block_.bound_tests;
        if (!(nearest > c_.cells[FanCells::cell_at(level, f, x, y)].reach)) return false;
      }
    }
    return true;
  }

  /// Halves a rectangle of cells until it is a few cells wide; returns its level.
  [[nodiscard]] std::uint32_t few_cells(std::uint32_t* x0, std::uint32_t* x1, std::uint32_t* y0,
                                        std::uint32_t* y1) const {
    std::uint32_t level = c_.level;
    for (; *x1 - *x0 >= kMostCellsAcross || *y1 - *y0 >= kMostCellsAcross; --level)
      *x0 /= 2, *x1 /= 2, *y0 /= 2, *y1 /= 2;
    return level;
  }

  void descend(std::uint32_t f, std::uint32_t in, const TriangleRun& run, std::uint32_t first) {
    if (std::popcount(in) >= kWorthALook && all_beyond(f, in)) return;
    bool has_edges = false;
    for (; in != 0 && !block_.is_full(); in &= in - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(in));
      TileRange ranges[kMostCellsAcross * kMostCellsAcross];
      const bool one_cell = x0_[lane] == x1_[lane] && y0_[lane] == y1_[lane];
      const std::uint32_t count = ranges_of(f, lane, ranges);
      if (count == 0) continue;
      if (!one_cell && !has_edges) make_edges(f);
      has_edges = has_edges || !one_cell;
      for (std::uint32_t r = 0; r < count; ++r)
        meet_tiles(ranges[r], lane, !one_cell,
                   {run.first + first + lane, run.corners(first + lane)});
    }
  }

  HWY_INLINE void make_edges(std::uint32_t f) {
    const FanFace axes = fan_face(f);
    for (std::size_t k = 0; k < kBundleSlots; k += hn::Lanes(Floats())) {
      V x[3], y[3], z[3];
      load(axes, k, x, y, z);
      MakeEdges(x, y, z, 0, 0, 1, k, &lanes_);
    }
  }

  /// The tiles of the cells under a rectangle, as ascending disjoint ranges.
  std::uint32_t ranges_of(std::uint32_t f, std::uint32_t lane, TileRange* ranges) {
    auto x0 = static_cast<std::uint32_t>(x0_[lane]), x1 = static_cast<std::uint32_t>(x1_[lane]);
    auto y0 = static_cast<std::uint32_t>(y0_[lane]), y1 = static_cast<std::uint32_t>(y1_[lane]);
    const std::uint32_t level = few_cells(&x0, &x1, &y0, &y1);
    std::uint32_t count = 0;
    for (std::uint32_t y = y0; y <= y1; ++y) {
      for (std::uint32_t x = x0; x <= x1; ++x) {
        const FanCell& cell = c_.cells[FanCells::cell_at(level, f, x, y)];
        ++block_.bound_tests;
        if (lanes_.depth[lane] > cell.reach || cell.first > cell.last) continue;
        count = add_range({cell.first, cell.last}, ranges, count);
      }
    }
    return count;
  }

  /// Keeps ranges in order and merges adjacent ones.
  static std::uint32_t add_range(TileRange range, TileRange* ranges, std::uint32_t count) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (ranges[i].last + 1 < range.first || range.last + 1 < ranges[i].first) {
        ranges[kept++] = ranges[i];
      } else {
        range.first = std::min(range.first, ranges[i].first);
        range.last = std::max(range.last, ranges[i].last);
      }
    }
    std::uint32_t at = kept;
    for (; at > 0 && ranges[at - 1].first > range.first; --at) ranges[at] = ranges[at - 1];
    ranges[at] = range;
    return kept + 1;
  }

  void meet_tiles(TileRange range, std::uint32_t lane, bool edges, const FanTriangle& triangle) {
    if (range.last - range.first < kFewTiles) {
      for_each_met(tiles_, range, lane, edges,
                   [&](std::uint32_t tile) { add_pair(tile, triangle); });
      return;
    }
    const TileRange groups{range.first / kGroupTiles, range.last / kGroupTiles};
    for_each_met(groups_, groups, lane, edges, [&](std::uint32_t group) {
      const TileRange part{std::max(range.first, group * kGroupTiles),
                           std::min(range.last, group * kGroupTiles + kGroupTiles - 1)};
      for_each_met(tiles_, part, lane, edges,
                   [&](std::uint32_t tile) { add_pair(tile, triangle); });
    });
  }

  /// Calls `body(i)` for the bounds of a range that a lane's triangle overlaps.
  template <class Body>
  HWY_INLINE void for_each_met(const BoundColumns& bounds, TileRange range, std::uint32_t lane,
                               bool edges, const Body& body) {
    const Floats d;
    const auto step = static_cast<std::uint32_t>(hn::Lanes(d));
    block_.bound_tests += range.last - range.first + 1;
    for (std::uint32_t i = range.first; i <= range.last; i += step) {
      M met = RectanglesMeet(bounds, i, lanes_, lane);
      if (edges && !hn::AllFalse(d, met)) met = hn::And(met, EdgesMeet(bounds, i, lanes_, lane));
      std::uint32_t bits = BitsOf(met);
      if (const std::uint32_t left = range.last - i + 1; left < step) bits &= (1u << left) - 1;
      for (; bits != 0; bits &= bits - 1)
        body(i + static_cast<std::uint32_t>(std::countr_zero(bits)));
    }
  }

  void add_pair(std::uint32_t tile, const FanTriangle& triangle) {
    block_.pairs.push_back({tile, triangle});
    ++block_.tile_pairs[tile];
  }

  const FanCells& c_;
  FanBlock& block_;
  BoundColumns tiles_, groups_;
  alignas(64) float from_origin_[3][3][kBundleSlots];  ///< [corner][axis]
  TriangleLanes lanes_;
  alignas(64) std::int32_t x0_[kBundleSlots], x1_[kBundleSlots], y0_[kBundleSlots],
      y1_[kBundleSlots];
};

void StreamTriangles(const FanCells& cells, const TriangleSource& source, std::uint32_t begin,
                     std::uint32_t end, FanBlock* block) {
  Stream stream(cells, block);
  source.for_each_part(begin, end,
                       [&](const TriangleRun& run, std::uint32_t first, std::uint32_t stop) {
                         for (; first < stop && !block->is_full(); first += kBundleSlots)
                           stream.sixteen(run, first, std::min(stop - first, kBundleSlots));
                       });
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(StreamTriangles);

void fan_stream(const FanCells& cells, const TriangleSource& source, std::uint32_t begin,
                std::uint32_t end, FanBlock* block) {
  HWY_DYNAMIC_DISPATCH(StreamTriangles)(cells, source, begin, end, block);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
