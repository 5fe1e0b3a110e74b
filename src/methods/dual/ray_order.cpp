#include "methods/dual/ray_order.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <utility>

#include "base/bits.h"
#include "base/vec.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kOriginBits = 9;  // per dimension, and as many for each slope
constexpr std::uint32_t kQuarterBits = 5;
constexpr std::uint32_t kKeyBits = kQuarterBits + 5 * kOriginBits;
constexpr std::uint32_t kBucketBits = 12;
constexpr std::size_t kKeysPerBlock = 16384;
constexpr std::size_t kSampledRays = 512;

/// Spreads bits: bit i of the position goes to bit 5 i.
struct SpreadTable {
  std::array<std::uint64_t, 1u << kOriginBits> bits{};
  constexpr SpreadTable() {
    for (std::uint32_t v = 0; v < bits.size(); ++v)
      for (std::uint32_t i = 0; i < kOriginBits; ++i)
        bits[v] |= std::uint64_t{(v >> i) & 1} << (5 * i);
  }
};
constexpr SpreadTable kSpread;

struct KeyMaker {
  Vec3 low, scale;

  /// Uses the box of some of the origins; origins outside are clamped to it.
  explicit KeyMaker(View<const Ray> rays) {
    Box box;
    const std::size_t stride = std::max<std::size_t>(1, rays.size / kSampledRays);
    for (std::size_t i = 0; i < rays.size; i += stride) {
      box.min = min(box.min, rays[i].origin);
      box.max = max(box.max, rays[i].origin);
    }
    low = box.min;
    const Vec3 size = box.max - box.min;
    const float largest = max_component(size);
    const float cells = largest > 0 ? static_cast<float>(1u << kOriginBits) / largest : 0;
    const float safe = cells < std::numeric_limits<float>::infinity() ? cells : 0;
    scale = {safe, safe, safe};
  }

  static std::uint64_t spread(float place) {
    constexpr float kLast = static_cast<float>((1u << kOriginBits) - 1);
    const float inside = place > 0 ? (place < kLast ? place : kLast) : 0;
    return kSpread.bits[static_cast<std::uint32_t>(inside)];
  }

  [[nodiscard]] std::uint64_t operator()(const Ray& ray) const {
    const std::uint32_t quarter = quarter_of(ray.direction);
    const int z = static_cast<int>(quarter / 8), x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
    const Vec3 d = ray.direction, o = (ray.origin - low) * scale;
    const float slope = static_cast<float>(1u << (kOriginBits - 1)) / std::fabs(component(d, z));
    constexpr float kMiddle = static_cast<float>(1u << (kOriginBits - 1));
    const std::uint64_t u = spread(component(d, x) * slope + kMiddle);
    const std::uint64_t v = spread(component(d, y) * slope + kMiddle);
    return std::uint64_t{quarter} << (5 * kOriginBits) | spread(o.x) << 4 | spread(o.y) << 3 |
           spread(o.z) << 2 | u << 1 | v;
  }
};

/// Moves every key to its bucket, given by its highest bits, in stable order; returns where the
/// buckets begin.
std::vector<std::uint32_t> scatter_to_buckets(const Executor& executor, const std::uint64_t* from,
                                              std::uint64_t* to, std::size_t count,
                                              std::uint32_t shift, std::size_t buckets) {
  const std::size_t blocks = div_ceil(count, kKeysPerBlock);
  std::vector<std::uint32_t> places(blocks * buckets);
  executor.for_each(blocks, 1, [&](std::size_t b) {
    std::uint32_t* counts = places.data() + b * buckets;
    const std::size_t end = std::min(count, (b + 1) * kKeysPerBlock);
    for (std::size_t i = b * kKeysPerBlock; i < end; ++i) ++counts[from[i] >> shift];
  });
  std::vector<std::uint32_t> starts(buckets + 1);
  std::uint32_t sum = 0;
  for (std::size_t k = 0; k < buckets; ++k) {
    starts[k] = sum;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::uint32_t n = places[b * buckets + k];
      places[b * buckets + k] = sum;
      sum += n;
    }
  }
  starts[buckets] = sum;
  executor.for_each(blocks, 1, [&](std::size_t b) {
    std::uint32_t* next = places.data() + b * buckets;
    const std::size_t end = std::min(count, (b + 1) * kKeysPerBlock);
    for (std::size_t i = b * kKeysPerBlock; i < end; ++i) to[next[from[i] >> shift]++] = from[i];
  });
  return starts;
}

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
    return row_ == 0 ? kKeysPerBlock : rows_of_tiles(kKeysPerBlock, row_);
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

/// A counting sort of bytes. A batch that is already in order needs little more than a pass over
/// the bytes.
void order_by_quarter(const Executor& executor, View<const Ray> rays, std::size_t row,
                      RayOrder* order) {
  const Sequence sequence(row);
  const std::size_t count = rays.size, block = sequence.block(), blocks = div_ceil(count, block);
  order->quarters.resize_uninitialized(count);
  const std::uint8_t* const quarters = order->quarters.data();
  std::vector<std::array<std::uint32_t, kQuarters>> places(blocks);
  std::atomic<bool> one_start = true;
  executor.for_each(blocks, 1, [&](std::size_t b) {
    std::array<std::uint32_t, kQuarters> counts{};
    const std::size_t begin = b * block, end = std::min(count, begin + block);
    if (!find_quarters(rays.slice(begin, end - begin), rays[0], order->quarters.data() + begin))
      one_start = false;
    // The order within a quarter does not matter here.
    Sequence(0).for_each_run(quarters, begin, end,
                             [&](std::uint8_t quarter, std::uint32_t n, const auto& /*number*/) {
                               counts[quarter] += n;
                             });
    places[b] = counts;
  });
  std::uint32_t sum = 0;
  for (std::uint32_t q = 0; q < kQuarters; ++q) {
    order->starts[q] = sum;
    for (std::size_t b = 0; b < blocks; ++b) sum += std::exchange(places[b][q], sum);
  }
  order->starts[kQuarters] = sum;
  order->one_start = one_start;
  executor.for_each(blocks, 1, [&](std::size_t b) {
    std::array<std::uint32_t, kQuarters> next = places[b];
    const std::size_t begin = b * block, end = std::min(count, begin + block);
    std::uint32_t* const out = order->rays.data();
    sequence.for_each_run(quarters, begin, end,
                          [&](std::uint8_t quarter, std::uint32_t n, const auto& number) {
                            std::uint32_t& at = next[quarter];
                            for (std::uint32_t k = 0; k < n; ++k)
                              out[at + k] = static_cast<std::uint32_t>(number(k));
                            at += n;
                          });
  });
}

void order_along_curve(const Executor& executor, View<const Ray> rays, RayOrder* order) {
  const std::size_t count = rays.size;
  order->keys.resize_uninitialized(count);
  order->spare.resize_uninitialized(count);
  // A key and the ray's number in one word: all words differ, so any sort is stable.
  const auto index_bits = std::max(1u, static_cast<std::uint32_t>(std::bit_width(count - 1)));
  const std::uint32_t kept = std::min(kKeyBits, 64 - index_bits);
  const std::uint32_t word_bits = kept + index_bits;
  const KeyMaker make_key(rays);
  executor.for_each(count, 4096, [&](std::size_t i) {
    order->keys[i] = make_key(rays[i]) >> (kKeyBits - kept) << index_bits | i;
  });
  const std::vector<std::uint32_t> starts =
      scatter_to_buckets(executor, order->keys.data(), order->spare.data(), count,
                         word_bits - kBucketBits, std::size_t{1} << kBucketBits);
  const std::uint64_t index_mask = (std::uint64_t{1} << index_bits) - 1;
  executor.for_each(starts.size() - 1, 32, [&](std::size_t k) {
    const std::uint32_t first = starts[k], size = starts[k + 1] - first;
    std::uint64_t* keys = order->spare.data() + first;
    if (size > 16) {
      hwy::Sorter()(keys, size, hwy::SortAscending());
    } else {
      std::sort(keys, keys + size);
    }
    for (std::uint32_t i = 0; i < size; ++i)
      order->rays[first + i] = static_cast<std::uint32_t>(keys[i] & index_mask);
  });
  for (std::uint32_t q = 0; q <= kQuarters; ++q)
    order->starts[q] = starts[std::size_t{q} << (kBucketBits - kQuarterBits)];
}

}  // namespace

std::size_t rows_of_tiles(std::size_t rays, std::size_t row) {
  const std::size_t tiles = kTileSide * row;
  return std::max<std::size_t>(1, (rays + tiles / 2) / tiles) * tiles;
}

void order_rays(const Executor& executor, View<const Ray> rays, Sorting sorting, RayOrder* order,
                std::size_t row) {
  order->rays.resize_uninitialized(rays.size);
  order->starts = {};
  order->one_start = false;
  if (rays.empty()) return;
  if (sorting == Sorting::kCurve) {
    order_along_curve(executor, rays, order);
  } else {
    order_by_quarter(executor, rays, row, order);
  }
}

}  // namespace raysheaf
