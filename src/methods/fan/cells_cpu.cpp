#include "methods/fan/cells.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/bits.h"

namespace raysheaf {
namespace {

constexpr std::size_t kLeastBlock = 8192;   ///< rays per block of the sort
constexpr std::uint32_t kGatherTiles = 32;  ///< tiles per task
/// With finer cells a triangle overlaps more of them; coarser ones cull less. With the rays evenly
/// distributed over one face, this is about sixty rays per cell.
constexpr std::uint32_t kMostLevel = 7;
/// The keys are finer than the grid, so that bundles are small squares, too.
constexpr std::uint32_t kBitsBelowGrid = 1;

std::uint32_t grid_level(std::size_t rays) {
  const auto bits = static_cast<std::uint32_t>(std::bit_width(rays));
  return std::clamp<std::uint32_t>(bits / 2, 5, kMostLevel + 3) - 3;
}

/// Computes keys, and sorts them by a stable counting sort in one pass: there are far fewer
/// distinct keys than rays, and the rays of an image come in rows, so that consecutive rays have
/// neighbouring keys.
class KeySort {
 public:
  KeySort(const Executor& executor, View<const Ray> rays, FanCells* c)
      : executor_(executor),
        rays_(rays),
        c_(*c),
        buckets_(std::size_t{kFanFaces + 1} << 2 * c->axis_bits),
        blocks_(std::clamp<std::size_t>(rays.size / kLeastBlock, 1, executor.threads())) {}

  /// Stops after the keys if the rays do not share one origin.
  FanRange run() {
    c_.keys.resize_uninitialized(rays_.size);
    c_.order.resize_uninitialized(rays_.size);
    c_.counters.resize_uninitialized(blocks_ * buckets_);
    const FanRange range = make_keys();
    if (!range.one_origin) return range;
    counts_to_places();
    executor_.for_each(blocks_, 1, [&](std::size_t block) {
      std::uint32_t* places = row(block);
      const std::uint32_t* keys = c_.keys.data();
      std::uint32_t* order = c_.order.data();
      for (std::size_t i = begin(block); i < begin(block + 1); ++i)
        order[places[keys[i]]++] = static_cast<std::uint32_t>(i);
    });
    // The last block's places are now the ends of the buckets.
    std::uint32_t first = 0;
    for (std::uint32_t f = 0; f < kFanFaces; ++f) {
      const std::uint32_t end = row(blocks_ - 1)[((f + std::size_t{1}) << 2 * c_.axis_bits) - 1];
      c_.faces[f] = FanFaceRays{first, end - first, 0, 0, {}};
      first = end;
    }
    c_.live_rays = first;
    return range;
  }

 private:
  [[nodiscard]] std::size_t begin(std::size_t block) const { return rays_.size * block / blocks_; }
  [[nodiscard]] std::uint32_t* row(std::size_t block) const {
    return c_.counters.data() + block * buckets_;
  }

  FanRange make_keys() {
    constexpr std::size_t kAtOnce = 1024;  // keys are counted while they are in the cache
    std::vector<FanRange> ranges(blocks_);
    executor_.for_each(blocks_, 1, [&](std::size_t block) {
      std::fill_n(row(block), buckets_, 0u);
      std::uint32_t* counts = row(block);
      for (std::size_t i = begin(block); i < begin(block + 1) && ranges[block].one_origin;) {
        const std::size_t end = std::min(i + kAtOnce, begin(block + 1));
        FanRange range;
        fan_keys(rays_.data, i, end, c_.axis_bits, c_.keys.data(), &range);
        ranges[block].include(range);
        for (; i < end; ++i) ++counts[c_.keys[i]];
      }
    });
    for (const FanRange& range : ranges) ranges[0].include(range);
    return ranges[0];
  }

  void counts_to_places() {
    std::uint32_t place = 0;
    for (std::size_t b = 0; b < buckets_; ++b) {
      for (std::size_t block = 0; block < blocks_; ++block)
        place += std::exchange(row(block)[b], place);
    }
  }

  const Executor& executor_;
  const View<const Ray> rays_;
  FanCells& c_;
  const std::size_t buckets_, blocks_;
};

/// Every face starts a group, so that no group has rays of two faces.
void lay_out_tiles(FanCells* c) {
  std::uint32_t tiles = 0;
  c->face_of_tile.clear();
  c->rays_of_tile.clear();
  for (std::uint32_t f = 0; f < kFanFaces; ++f) {
    FanFaceRays& face = c->faces[f];
    face.first_tile = tiles;
    face.tile_count = div_ceil(face.ray_count, kTileSlots);
    tiles += div_ceil(face.tile_count, kGroupTiles) * kGroupTiles;
    c->face_of_tile.resize(tiles, static_cast<std::uint8_t>(f));
    c->rays_of_tile.resize(tiles, 0);
    for (std::uint32_t t = 0; t < face.tile_count; ++t)
      c->rays_of_tile[face.first_tile + t] = std::min(kTileSlots, face.ray_count - t * kTileSlots);
  }
  c->tile_count = tiles;
  c->rays.resize(std::size_t{tiles} * kTileSlots);
  c->bundles.resize(std::size_t{tiles} * kTileBundles);
  // SIMD loads may start at the last tile.
  c->tiles.resize(tiles + std::size_t{kBundleSlots});
  c->groups.resize(tiles / kGroupTiles + std::size_t{kBundleSlots});
}

void clear_cells(const Executor& executor, FanCells* c) {
  const std::size_t count = FanCells::cell_at(c->level + 1, 0, 0, 0);
  c->cells.resize_uninitialized(count);
  executor.for_each_block(count, 16384, [&](std::size_t begin, std::size_t end) {
    std::fill(c->cells.data() + begin, c->cells.data() + end, FanCell{});
  });
}

void gather(const Executor& executor, View<const Ray> rays, FanCells* c) {
  const std::size_t tasks = div_ceil(c->tile_count, kGatherTiles);
  std::vector<FanSeam> seams(tasks);
  executor.for_each(tasks, 1, [&](std::size_t task) {
    const auto begin = static_cast<std::uint32_t>(task) * kGatherTiles;
    fan_gather(rays.data, c, begin, std::min(begin + kGatherTiles, c->tile_count), &seams[task]);
  });
  for (const FanSeam& seam : seams) {
    for (int end = 0; end < 2; ++end)
      if (seam.at[end] != FanSeam::kNone) c->cells[seam.at[end]].include(seam.cell[end]);
  }
}

void bound_groups_and_faces(FanCells* c) {
  for (std::uint32_t g = 0; g < c->groups.u0.size(); ++g) {
    FanBound bound;
    for (std::uint32_t t = g * kGroupTiles; t < std::min((g + 1) * kGroupTiles, c->tile_count); ++t)
      bound.include(c->tiles.at(t));
    c->groups.set(g, bound);
    if (g * kGroupTiles < c->tile_count)
      c->faces[c->face_of_tile[g * kGroupTiles]].bound.include(bound);
  }
}

/// Computes coarser grids from finer ones.
void build_pyramid(const Executor& executor, FanCells* c) {
  for (std::uint32_t level = c->level; level-- > 0;) {
    const std::uint32_t side = 1u << level;
    executor.for_each(kFanFaces * side, 16384 / side, [&](std::size_t row) {
      const auto face = static_cast<std::uint32_t>(row / side);
      if (c->faces[face].ray_count == 0) return;
      const auto y = static_cast<std::uint32_t>(row % side);
      FanCell* out = c->cells.data() + FanCells::cell_at(level, face, 0, y);
      const FanCell* upper = c->cells.data() + FanCells::cell_at(level + 1, face, 0, 2 * y);
      const FanCell* lower = c->cells.data() + FanCells::cell_at(level + 1, face, 0, 2 * y + 1);
      for (std::uint32_t x = 0; x < side; ++x) {
        FanCell cell = upper[2 * x];
        cell.include(upper[2 * x + 1]);
        cell.include(lower[2 * x]);
        cell.include(lower[2 * x + 1]);
        out[x] = cell;
      }
    });
  }
}

}  // namespace

bool make_cells(const Executor& executor, View<const Ray> rays, FanCells* c) {
  c->origin = rays[0].origin;
  c->level = grid_level(rays.size);
  c->axis_bits = c->level + kBitsBelowGrid;
  const FanRange range = KeySort(executor, rays, c).run();
  if (!range.one_origin) return false;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  c->behind = range.forward ? range.largest_along * 0x1p-119f + 0x1p-119f : kInfinity;
  lay_out_tiles(c);
  clear_cells(executor, c);
  gather(executor, rays, c);
  bound_groups_and_faces(c);
  build_pyramid(executor, c);
  return true;
}

}  // namespace raysheaf
