#include "methods/dual/ray_order.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "base/bits.h"

namespace raysheaf {
namespace {

constexpr std::size_t kRaysPerBlock = 16384;

/// Neighbours that are tested together: usually all are in one quarter, and are moved at once.
constexpr std::size_t kRayRun = 8;
/// The same for the tiles of an image.
constexpr std::size_t kTileSide = 4, kTileRays = kTileSide * kTileSide;

bool is_one_quarter(const std::uint8_t* quarters) {
  std::uint64_t all;
  std::memcpy(&all, quarters, sizeof all);
  return all == *quarters * std::uint64_t{0x0101010101010101};
}

/// The same for a tile; `quarters` points to that of its first ray.
bool is_one_quarter(const std::uint8_t* quarters, std::size_t row) {
  std::uint32_t differ = 0;
  for (std::size_t y = 0; y < kTileSide; ++y) {
    std::uint32_t four;
    std::memcpy(&four, quarters + y * row, sizeof four);
    differ |= four ^ *quarters * std::uint32_t{0x01010101};
  }
  return differ == 0;
}

/// The order of rays of the same quarter.
class Sequence {
 public:
  explicit Sequence(std::size_t row) : row_(row) {}

  /// Rays per task: whole rows of tiles.
  [[nodiscard]] std::size_t block() const {
    return row_ == 0 ? kRaysPerBlock : rows_of_tiles(kRaysPerBlock, row_);
  }

  /// Calls `run(quarter, count, number)` for runs of `count` rays of one quarter, whose k-th ray is
  /// `number(k)`. `begin` is the first ray of a block.
  template <class Run>
  void for_each_run(const std::uint8_t* quarters, std::size_t begin, std::size_t end,
                    const Run& run) const {
    if (row_ == 0) return for_each_run_in_line(quarters, begin, end, run);
    const std::size_t tiles = kTileSide * row_;
    for (; begin + tiles <= end; begin += tiles) for_each_tile(quarters, begin, run);
    for_each_run_in_line(quarters, begin, end, run);
  }

 private:
  template <class Run>
  static void for_each_run_in_line(const std::uint8_t* quarters, std::size_t begin, std::size_t end,
                                   const Run& run) {
    for (std::size_t i = begin; i < end;) {
      if (i + kRayRun <= end && is_one_quarter(quarters + i)) {
        run(quarters[i], kRayRun, [i](std::size_t k) { return i + k; });
        i += kRayRun;
        continue;
      }
      for (const std::size_t stop = std::min(i + kRayRun, end); i < stop; ++i)
        run(quarters[i], 1, [i](std::size_t) { return i; });
    }
  }

  /// The tiles of kTileSide rows.
  template <class Run>
  void for_each_tile(const std::uint8_t* quarters, std::size_t begin, const Run& run) const {
    const std::size_t row = row_, whole = row / kTileSide * kTileSide;
    for (std::size_t i = begin; i < begin + whole; i += kTileSide) {
      const auto number = [i, row](std::size_t k) {
        return i + k / kTileSide * row + k % kTileSide;
      };
      if (is_one_quarter(quarters + i, row)) {
        run(quarters[i], kTileRays, number);
        continue;
      }
      for (std::size_t k = 0; k < kTileRays; ++k)
        run(quarters[number(k)], 1, [&](std::size_t) { return number(k); });
    }
    for (std::size_t y = 0; y < kTileSide; ++y)
      for_each_run_in_line(quarters, begin + y * row + whole, begin + (y + 1) * row, run);
  }

  std::size_t row_;
};

}  // namespace

std::size_t rows_of_tiles(std::size_t rays, std::size_t row) {
  const std::size_t tiles = kTileSide * row;
  return std::max<std::size_t>(1, (rays + tiles / 2) / tiles) * tiles;
}

void order_rays(const Executor& executor, View<const Ray> rays, RayOrder* order, std::size_t row) {
  const Sequence sequence(row);
  const std::size_t count = rays.size, block = sequence.block();
  order->rays.resize_uninitialized(count);
  order->quarters.resize_uninitialized(count);
  const std::uint8_t* const quarters = order->quarters.data();
  std::uint32_t* const out = order->rays.data();
  std::atomic<bool> one_start = count > 0;
  order->sort.count(
      executor, div_ceil(count, block), kQuarters, [&](std::size_t b, std::uint32_t* counts) {
        const std::size_t begin = b * block, end = std::min(count, begin + block);
        if (!find_quarters(rays.slice(begin, end - begin), rays[0], order->quarters.data() + begin))
          one_start = false;
        // The order within a quarter does not matter here.
        Sequence(0).for_each_run(quarters, begin, end,
                                 [&](std::uint8_t quarter, std::uint32_t n,
                                     const auto& /*number*/) { counts[quarter] += n; });
      });
  order->one_start = one_start;
  std::copy_n(order->sort.starts().begin(), order->starts.size(), order->starts.begin());
  order->sort.put(executor, [&](std::size_t b, std::uint32_t* next) {
    const std::size_t begin = b * block, end = std::min(count, begin + block);
    sequence.for_each_run(quarters, begin, end,
                          [&](std::uint8_t quarter, std::uint32_t n, const auto& number) {
                            const std::uint32_t at = next[quarter];
                            for (std::uint32_t k = 0; k < n; ++k)
                              out[at + k] = static_cast<std::uint32_t>(number(k));
                            next[quarter] = at + n;
                          });
  });
}

}  // namespace raysheaf
