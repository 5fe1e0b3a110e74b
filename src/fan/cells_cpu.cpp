#include "fan/cells.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/bits.h"

namespace raysheaf {
namespace {

constexpr std::size_t kSortBlock = 16384;
constexpr std::uint32_t kGatherTiles = 32;  ///< a task
/// Rays a cell of the finest grid, were they spread evenly over one face: fewer and triangles meet
/// more cells, more and cells tell less.
constexpr std::uint32_t kMostLevel = 8;
/// The keys are finer than the grid, so that packets are small squares, too.
constexpr std::uint32_t kBitsBelowGrid = 2;

std::uint32_t grid_level(std::size_t rays) {
  const auto bits = static_cast<std::uint32_t>(std::bit_width(rays));
  return std::clamp<std::uint32_t>(bits / 2, 4, kMostLevel + 2) - 2;
}

/// The stable counting sort of one digit: places of each block's buckets, then rows there.
struct DigitSort {
  const Executor& executor;
  std::size_t count;
  std::uint32_t shift, bits;
  Buffer<std::uint32_t>& counters;

  [[nodiscard]] std::size_t blocks() const { return div_ceil(count, kSortBlock); }
  [[nodiscard]] std::uint32_t digit(std::uint32_t key) const {
    return (key >> shift) & ((1u << bits) - 1);
  }

  /// `key(i)` and `put(place, i)`.
  template <class Key, class Put>
  void run(const Key& key, const Put& put) const {
    const std::size_t buckets = std::size_t{1} << bits;
    counters.resize_uninitialized(blocks() * buckets);
    const auto each_block = [&](const auto& body) {
      executor.for_each(blocks(), 1, [&](std::size_t block) {
        const std::size_t begin = block * kSortBlock;
        body(counters.data() + block * buckets, begin, std::min(begin + kSortBlock, count));
      });
    };
    each_block([&](std::uint32_t* row, std::size_t begin, std::size_t end) {
      std::fill_n(row, buckets, 0u);
      for (std::size_t i = begin; i < end; ++i) ++row[digit(key(i))];
    });
    counts_to_places(buckets);
    each_block([&](std::uint32_t* row, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) put(row[digit(key(i))]++, i);
    });
  }

  void counts_to_places(std::size_t buckets) const {
    std::uint32_t place = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
      for (std::size_t block = 0; block < blocks(); ++block)
        place += std::exchange(counters[block * buckets + b], place);
    }
  }
};

FanRange make_keys(const Executor& executor, View<const Ray> rays, FanCells* c) {
  c->keys.resize_uninitialized(rays.size);
  const std::size_t blocks = div_ceil(rays.size, kSortBlock);
  std::vector<FanRange> ranges(blocks);
  executor.for_each(blocks, 1, [&](std::size_t block) {
    const std::size_t begin = block * kSortBlock;
    fan_keys(rays.data, begin, std::min(begin + kSortBlock, rays.size), c->axis_bits,
             c->keys.data(), &ranges[block]);
  });
  FanRange all;
  for (const FanRange& range : ranges) {
    all.forward = all.forward && range.forward;
    all.largest_along = std::max(all.largest_along, range.largest_along);
  }
  return all;
}

/// `order` and the faces' shares of it.
void sort_rays(const Executor& executor, std::size_t count, FanCells* c) {
  const std::uint32_t key_bits = 2 * c->axis_bits + 3, low = key_bits / 2;
  c->rows.resize_uninitialized(count);
  c->order.resize_uninitialized(count);
  const std::uint32_t* keys = c->keys.data();
  std::uint64_t* rows = c->rows.data();
  std::uint32_t* order = c->order.data();
  DigitSort{executor, count, 0, low, c->counters}.run(
      [=](std::size_t i) { return keys[i]; },
      [=](std::uint32_t place, std::size_t i) { rows[place] = std::uint64_t{keys[i]} << 32 | i; });
  const auto key_of_row = [=](std::size_t i) { return static_cast<std::uint32_t>(rows[i] >> 32); };
  DigitSort{executor, count, low, key_bits - low, c->counters}.run(
      key_of_row, [=](std::uint32_t place, std::size_t i) {
        order[place] = static_cast<std::uint32_t>(rows[i]);
      });
  // The last block's counters have become the ends of the buckets; the highest digit has the face.
  const std::size_t buckets = std::size_t{1} << (key_bits - low), a_face = buckets / 8;
  const std::uint32_t* ends = c->counters.data() + (div_ceil(count, kSortBlock) - 1) * buckets;
  std::uint32_t begin = 0;
  for (std::uint32_t f = 0; f < kFanFaces; ++f) {
    const std::uint32_t end = ends[(f + 1) * a_face - 1];
    c->faces[f] = FanFaceRays{begin, end - begin, 0, 0, {}};
    begin = end;
  }
  c->live_rays = begin;
}

/// Every face starts a group, so that no group has rays of two.
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
  c->packets.resize(std::size_t{tiles} * kTilePackets);
  c->tiles.resize(tiles);
  c->groups.resize(tiles / kGroupTiles + kGroupTiles);
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

/// Coarser grids from finer ones.
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

void make_cells(const Executor& executor, View<const Ray> rays, FanCells* c) {
  c->origin = rays[0].origin;
  c->level = grid_level(rays.size);
  c->axis_bits = c->level + kBitsBelowGrid;
  const FanRange range = make_keys(executor, rays, c);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  c->behind = range.forward ? range.largest_along * 0x1p-119f + 0x1p-119f : kInfinity;
  sort_rays(executor, rays.size, c);
  lay_out_tiles(c);
  clear_cells(executor, c);
  gather(executor, rays, c);
  bound_groups_and_faces(c);
  build_pyramid(executor, c);
}

}  // namespace raysheaf
