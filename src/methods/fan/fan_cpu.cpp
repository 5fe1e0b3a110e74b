#include "methods/fan/fan.h"

#include <algorithm>
#include <utility>

#include "base/bits.h"
#include "exec/stopwatch.h"
#include "methods/fan/cells.h"
#include "methods/fan/stream.h"

namespace raysheaf {

struct FanMemory::Arrays {
  FanCells cells;
  std::vector<FanBlock> blocks;
  Buffer<FanTriangle> triangles;          ///< sorted by tile
  std::vector<std::uint32_t> tile_begin;  ///< the index of each tile's first triangle
  std::vector<FanTileCounts> tile_counts;
};

FanMemory::FanMemory() : arrays_(std::make_unique<Arrays>()) {}
FanMemory::~FanMemory() = default;
FanMemory::FanMemory(FanMemory&&) noexcept = default;
FanMemory& FanMemory::operator=(FanMemory&&) noexcept = default;

namespace {

/// Triangles per block, and the maximum number of blocks: each has a counter for every tile.
constexpr std::size_t kTriangleBlockSize = 1024;
constexpr std::size_t kMostBlocks = 128;

/// Returns the number of pairs; it is too large if a block is full.
std::uint64_t stream(const Executor& executor, const TriangleSource& source,
                     std::uint64_t most_pairs, FanMemory::Arrays* a) {
  const std::size_t count =
      std::clamp<std::size_t>(source.count / kTriangleBlockSize, 1, kMostBlocks);
  a->blocks.resize(count);
  executor.for_each(count, 1, [&](std::size_t i) {
    FanBlock& block = a->blocks[i];
    block.pairs.clear();
    block.tile_pairs.assign(a->cells.tile_count, 0);
    block.bound_tests = 0;
    block.most_pairs = 4 * most_pairs / count;
    const std::uint64_t n = source.count;
    fan_stream(a->cells, source, static_cast<std::uint32_t>(n * i / count),
               static_cast<std::uint32_t>(n * (i + 1) / count), &block);
  });
  std::uint64_t pairs = 0;
  bool full = false;
  for (const FanBlock& block : a->blocks) {
    pairs += block.pairs.size();
    full = full || block.is_full();
  }
  return full ? std::max(pairs, most_pairs + 1) : pairs;
}

/// Sorts the blocks' pairs by tile; a tile's triangles stay in order.
void sort_pairs(const Executor& executor, FanMemory::Arrays* a) {
  const std::uint32_t tiles = a->cells.tile_count;
  a->tile_begin.resize(tiles + std::size_t{1});
  std::uint32_t place = 0;
  for (std::uint32_t tile = 0; tile < tiles; ++tile) {
    a->tile_begin[tile] = place;
    for (FanBlock& block : a->blocks) place += std::exchange(block.tile_pairs[tile], place);
  }
  a->tile_begin[tiles] = place;
  a->triangles.resize_uninitialized(place);
  executor.for_each(a->blocks.size(), 1, [&](std::size_t i) {
    FanBlock& block = a->blocks[i];
    std::uint32_t* places = block.tile_pairs.data();
    for (const FanPair& pair : block.pairs) a->triangles[places[pair.tile]++] = pair.triangle;
  });
}

void trace_tiles(const Executor& executor, const FanTileTask& task, FanMemory::Arrays* a) {
  a->tile_counts.assign(a->cells.tile_count, {});
  executor.for_each(a->cells.tile_count, 2, [&](std::size_t i) {
    const auto tile = static_cast<std::uint32_t>(i);
    if (a->cells.rays_of_tile[tile] == 0) return;
    const std::uint32_t begin = a->tile_begin[tile];
    a->tile_counts[tile] =
        fan_tile(task, tile, {a->triangles.data() + begin, a->tile_begin[tile + 1] - begin});
  });
}

void add_counts(const FanMemory::Arrays& a, FanCounts* counts) {
  for (const FanBlock& block : a.blocks) counts->bound_tests += block.bound_tests;
  for (const FanTileCounts& tile : a.tile_counts) {
    counts->bound_tests += tile.bound_tests;
    counts->triangle_tests += tile.triangle_tests;
  }
}

/// Distributes the tests of bounds that hold many rays evenly.
void share_stream_tests(const Executor& executor, const FanMemory::Arrays& a,
                        View<float> ray_tests) {
  std::uint64_t tests = 0;
  for (const FanBlock& block : a.blocks) tests += block.bound_tests;
  const float each = static_cast<float>(tests) / static_cast<float>(ray_tests.size);
  executor.for_each(ray_tests.size, kCopyGrain, [&](std::size_t i) { ray_tests[i] += each; });
}

}  // namespace

std::size_t FanMemory::bytes() const {
  const FanCells& c = arrays_->cells;
  std::size_t bytes = 7 * c.rays.ray.capacity_bytes() + c.bundles.bytes() + c.tiles.bytes() +
                      c.groups.bytes() + c.cells.capacity_bytes() + c.keys.capacity_bytes() +
                      c.counters.capacity_bytes() + c.order.capacity_bytes() +
                      arrays_->triangles.capacity_bytes();
  for (const FanBlock& block : arrays_->blocks)
    bytes += block.pairs.capacity() * sizeof(FanPair) + block.tile_pairs.capacity() * 4;
  return bytes;
}

bool occluded_in_fan(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
                     const FanOptions& options, View<std::uint8_t> occluded, View<float> ray_tests,
                     FanCounts* counts) {
  FanCounts unused;
  if (counts == nullptr) counts = &unused;
  if (rays.empty()) return true;
  FanMemory own;
  FanMemory::Arrays& a = options.memory != nullptr ? options.memory->arrays() : own.arrays();
  Stopwatch watch;
  if (!make_cells(executor, rays, &a.cells)) return false;
  for (std::size_t i = a.cells.live_rays; i < rays.size; ++i) occluded[a.cells.order[i]] = 0;
  counts->order_ms += watch.lap_ms();
  const std::uint64_t pairs = stream(executor, source, options.most_pairs, &a);
  counts->pairs += pairs;
  if (pairs <= options.most_pairs) sort_pairs(executor, &a);
  counts->hierarchy_ms += watch.lap_ms();
  if (pairs > options.most_pairs) return false;
  trace_tiles(executor, {a.cells, source, rays, options.facing, occluded, ray_tests}, &a);
  if (!ray_tests.empty()) share_stream_tests(executor, a, ray_tests);
  counts->traverse_ms += watch.lap_ms();
  if (options.count) add_counts(a, counts);
  return true;
}

}  // namespace raysheaf
