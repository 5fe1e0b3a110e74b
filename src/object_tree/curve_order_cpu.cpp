#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/curve_order.h"
#include "object_tree/tree_kernels.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kMinSortBlock = 8192, kMostSortBlocks = 32;
constexpr std::uint32_t kMostBucketBits = 12;
/// Consecutive buckets share a task up to this many items.
constexpr std::uint32_t kTaskItems = 1024;
/// A bucket with more items than this, and than a part of all, is divided again: it is a small part
/// of the scene's box with many of its triangles.
constexpr std::uint32_t kMostTaskItems = 8192, kPartOfItems = 64;
constexpr std::uint32_t kDividingBits = 10;
/// Up to this many items are sorted by comparison.
constexpr std::uint32_t kFewItems = 64;
/// More are sorted by this many of the highest bits in which they differ, in digits; few are then
/// out of order.
constexpr std::uint32_t kSortedBits = 24, kRunDigitBits = 8;

/// If more than this fraction of the triangles has a different bucket than the preceding triangle,
/// the triangles are moved with their keys instead of being fetched afterwards.
constexpr double kMostJumps = 0.3;
/// Fewer triangles fit into a cache in any order.
constexpr double kManyTriangles = 200000;

/// Moves per item of an insertion sort, above which sorting by digits is faster.
constexpr std::uint32_t kMostMoves = 4;

/// Triangles are joined if that leaves at most this many items per triangle.
constexpr double kMostItemsJoined = 0.45;

struct Block {
  std::uint32_t begin, end;  ///< triangles
  std::uint32_t items = 0;   ///< strips, or all triangles
  std::uint32_t kept = 0, jumps = 0;
  Box centers;
  std::vector<std::uint32_t> left_out;
};

std::vector<Block> blocks_of(std::uint32_t count) {
  std::vector<Block> blocks(std::clamp(count / kMinSortBlock, 1u, kMostSortBlocks));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    blocks[b].begin = static_cast<std::uint32_t>(std::uint64_t{count} * b / blocks.size());
    blocks[b].end = static_cast<std::uint32_t>(std::uint64_t{count} * (b + 1) / blocks.size());
  }
  return blocks;
}

MortonCurve curve_through(const Box& centers, std::uint32_t id_bits) {
  MortonCurve curve;
  curve.low = centers.min;
  curve.id_bits = id_bits;
  curve.bits = std::min(16u, (64 - curve.id_bits) / 3);
  const float size = max_component(centers.max - centers.min);
  if (!(size > 0)) return curve;
  curve.up = size < 0x1p-60f ? 0x1p80f : 1;
  curve.scale = static_cast<float>(1u << curve.bits) / (size * curve.up);
  return curve;
}

/// Turns the blocks' counts of keys into the places of their first keys; returns the first place of
/// every bucket.
std::vector<std::uint32_t> count_to_place(std::size_t blocks, std::size_t buckets,
                                          std::uint32_t* counters) {
  std::vector<std::uint32_t> starts(buckets + 1);
  for (std::size_t block = 0; block < blocks; ++block)
    for (std::size_t b = 0; b < buckets; ++b) starts[b + 1] += counters[block * buckets + b];
  for (std::size_t b = 0; b < buckets; ++b) starts[b + 1] += starts[b];
  std::vector<std::uint32_t> place(starts.begin(), starts.end() - 1);
  for (std::size_t block = 0; block < blocks; ++block)
    for (std::size_t b = 0; b < buckets; ++b) {
      const std::uint32_t count = counters[block * buckets + b];
      counters[block * buckets + b] = place[b];
      place[b] += count;
    }
  return starts;
}

/// How often the bucket changes, estimated from every eighth key.
std::uint32_t jumps_between(View<const std::uint64_t> keys, std::uint32_t shift) {
  std::uint32_t jumps = 0;
  for (std::size_t i = 8; i < keys.size; i += 8) jumps += (keys[i] ^ keys[i - 1]) >> shift != 0;
  return 8 * jumps;
}

bool in_no_order(const std::vector<Block>& blocks) {
  double jumps = 0, kept = 0;
  for (const Block& block : blocks) jumps += block.jumps, kept += block.kept;
  return kept >= kManyTriangles && jumps > kMostJumps * kept;
}

/// The bits of the key in which items differ from the first.
std::uint64_t differing_bits(const std::uint64_t* items, std::uint32_t count, std::uint64_t first,
                             std::uint32_t id_bits) {
  std::uint64_t differing = 0;
  for (std::uint32_t i = 0; i < count; ++i) differing |= items[i] ^ first;
  return differing >> id_bits << id_bits;
}

/// Makes tasks from buckets of `scratch->sorted`.
class TaskMaker {
 public:
  TaskMaker(const Executor& executor, std::uint32_t id_bits, TreeScratch* scratch)
      : executor_(executor),
        id_bits_(id_bits),
        most_(std::max(kMostTaskItems,
                       static_cast<std::uint32_t>(scratch->sorted.size() / kPartOfItems))),
        scratch_(*scratch) {}

  /// Halves the buckets [begin, end), along the curve's own cells, until a task is small.
  /// `starts`: the buckets' first places, relative to `first`.
  void add(std::uint32_t first, const std::vector<std::uint32_t>& starts, std::size_t begin,
           std::size_t end) {
    const std::uint32_t count = starts[end] - starts[begin];
    if (count == 0) return;
    if (count > kTaskItems && end - begin > 1) {
      const std::size_t middle = begin + (end - begin) / 2;
      add(first, starts, begin, middle);
      add(first, starts, middle, end);
    } else if (count <= most_) {
      scratch_.tasks.push_back({first + starts[begin], count});
    } else {
      divide(first + starts[begin], count);
    }
  }

 private:
  /// Divides a bucket by the highest bits in which its keys differ.
  void divide(std::uint32_t first, std::uint32_t count) {
    std::uint64_t* const items = scratch_.sorted.data() + first;
    std::uint64_t* const spare = scratch_.keys.data() + first;
    const std::size_t blocks = div_ceil(count, kMinSortBlock);
    const auto for_each_block = [&](const auto& body) {
      executor_.for_each(blocks, 1, [&](std::size_t block) {
        const auto begin = static_cast<std::uint32_t>(block) * kMinSortBlock;
        body(block, begin, std::min(count, begin + kMinSortBlock));
      });
    };
    std::vector<std::uint64_t> differ(blocks);
    for_each_block([&](std::size_t block, std::uint32_t begin, std::uint32_t end) {
      differ[block] = differing_bits(items + begin, end - begin, items[0], id_bits_);
    });
    std::uint64_t differing = 0;
    for (const std::uint64_t each : differ) differing |= each;
    if (differing == 0) return scratch_.tasks.push_back({first, count});
    const auto width = static_cast<std::uint32_t>(std::bit_width(differing));
    const std::uint32_t bits = std::min(kDividingBits, width - id_bits_), shift = width - bits;
    const std::size_t buckets = std::size_t{1} << bits;
    const auto bucket_of = [&](std::uint64_t item) { return (item >> shift) & (buckets - 1); };
    std::vector<std::uint32_t> counters(blocks * buckets);
    for_each_block([&](std::size_t block, std::uint32_t begin, std::uint32_t end) {
      std::uint32_t* const counts = counters.data() + block * buckets;
      for (std::uint32_t i = begin; i < end; ++i) ++counts[bucket_of(items[i])];
    });
    const std::vector<std::uint32_t> starts = count_to_place(blocks, buckets, counters.data());
    for_each_block([&](std::size_t block, std::uint32_t begin, std::uint32_t end) {
      std::uint32_t* const place = counters.data() + block * buckets;
      for (std::uint32_t i = begin; i < end; ++i) spare[place[bucket_of(items[i])]++] = items[i];
    });
    for_each_block([&](std::size_t /*block*/, std::uint32_t begin, std::uint32_t end) {
      std::copy(spare + begin, spare + end, items + begin);
    });
    add(first, starts, 0, buckets);
  }

  const Executor& executor_;
  std::uint32_t id_bits_, most_;
  TreeScratch& scratch_;
};

void sort_by_digits(std::uint64_t* items, std::uint64_t* spare, std::uint32_t count,
                    std::uint64_t differing) {
  constexpr std::uint32_t kBuckets = 1u << kRunDigitBits;
  std::uint64_t *from = items, *to = spare;
  while (differing != 0) {
    const auto shift = static_cast<std::uint32_t>(std::countr_zero(differing));
    const auto digit = [&](std::uint64_t item) { return (item >> shift) & (kBuckets - 1); };
    std::uint32_t place[kBuckets] = {};
    for (std::uint32_t i = 0; i < count; ++i) ++place[digit(from[i])];
    std::uint32_t sum = 0;
    for (std::uint32_t& p : place) sum += std::exchange(p, sum);
    for (std::uint32_t i = 0; i < count; ++i) to[place[digit(from[i])]++] = from[i];
    std::swap(from, to);
    differing = shift + kRunDigitBits < 64
                    ? differing >> (shift + kRunDigitBits) << (shift + kRunDigitBits)
                    : 0;
  }
  if (from != items) std::memcpy(items, from, count * sizeof *items);
}

/// Sorts nearly sorted items by insertion. Gives up, with the items in another order, after a few
/// moves per item.
bool finish_sorting(std::uint64_t* items, std::uint32_t count, std::uint32_t id_bits) {
  std::uint64_t moves = 0;
  for (std::uint32_t i = 1; i < count; ++i) {
    const std::uint64_t item = items[i];
    std::uint32_t to = i;
    for (; to > 0 && item >> id_bits < items[to - 1] >> id_bits; --to) items[to] = items[to - 1];
    items[to] = item;
    moves += i - to;
    if (moves > kMostMoves * std::uint64_t{count}) return false;
  }
  return true;
}

}  // namespace

bool joins_well(const TriangleSource& source) {
  constexpr std::uint32_t kWindows = 32, kLength = 64;
  if (source.count > UINT32_MAX >> kStripBits) return false;
  float columns[3][kLength];
  std::uint32_t strips[kLength];
  std::vector<std::uint32_t> left_out;
  Box bounds;
  const std::uint32_t windows = std::clamp(source.count / kLength, 1u, kWindows);
  double joined = 0, all = 0;
  for (std::uint32_t w = 0; w < windows; ++w) {
    const auto begin = static_cast<std::uint32_t>(std::uint64_t{source.count} * w / windows);
    const std::uint32_t end = std::min(begin + kLength, source.count);
    joined += join_triangles(source, begin, end, {{columns[0], columns[1], columns[2]}}, strips,
                             &bounds, &left_out);
    all += end - begin;
  }
  return joined <= kMostItemsJoined * all;
}

CurveItems bucket_along_curve(const Executor& executor, const TriangleSource& source,
                              TreeScratch* scratch, std::vector<std::uint32_t>* left_out) {
  const std::uint32_t count = source.count;
  left_out->clear();
  scratch->tasks.clear();
  if (count == 0) return {};
  const bool joins = joins_well(source);
  constexpr std::size_t kPadding = 64;
  const std::size_t column = count + kPadding;
  scratch->centers.resize_uninitialized(3 * column);
  scratch->strips.resize_uninitialized(joins ? count : 0);
  float* const x = scratch->centers.data();
  const auto centers_from = [&](std::uint32_t place) {
    return CenterColumns{{x + place, x + column + place, x + 2 * column + place}};
  };
  std::vector<Block> blocks = blocks_of(count);
  executor.for_each(blocks.size(), 1, [&](std::size_t b) {
    Block& block = blocks[b];
    if (joins) {
      block.items =
          join_triangles(source, block.begin, block.end, centers_from(block.begin),
                         scratch->strips.data() + block.begin, &block.centers, &block.left_out);
    } else {
      block.items = block.end - block.begin;
      measure_centers(source, block.begin, block.end, centers_from(0), &block.centers,
                      &block.left_out);
    }
  });
  Box bounds;
  std::uint32_t items = 0;
  for (const Block& block : blocks) {
    items += block.items;
    bounds.min = min(bounds.min, block.centers.min);
    bounds.max = max(bounds.max, block.centers.max);
    left_out->insert(left_out->end(), block.left_out.begin(), block.left_out.end());
  }
  const MortonCurve curve =
      curve_through(bounds, std::max(1u, bits_for(count)) + (joins ? kStripBits : 0));
  const std::uint32_t bucket_bits =
      std::min({kMostBucketBits, 3 * curve.bits, std::max(8u, bits_for(items)) - 8});
  const std::size_t buckets = std::size_t{1} << bucket_bits;
  const std::uint32_t bucket_shift = 3 * curve.bits - bucket_bits;
  scratch->keys.resize_uninitialized(count);
  scratch->sorted.resize_uninitialized(items);
  scratch->counters.resize_uninitialized(blocks.size() * buckets);
  executor.for_each(blocks.size(), 1, [&](std::size_t b) {
    std::uint32_t* counts = scratch->counters.data() + b * buckets;
    std::fill_n(counts, buckets, 0u);
    const std::uint32_t begin = blocks[b].begin, end = begin + blocks[b].items;
    blocks[b].kept = write_keys(centers_from(0), joins ? scratch->strips.data() : nullptr, curve,
                                begin, end, bucket_shift, scratch->keys.data() + begin, counts);
    blocks[b].jumps =
        jumps_between({scratch->keys.data() + begin, blocks[b].kept}, curve.id_bits + bucket_shift);
  });
  const std::vector<std::uint32_t> starts =
      count_to_place(blocks.size(), buckets, scratch->counters.data());
  const bool moves_triangles = !joins && in_no_order(blocks);
  scratch->records.resize_uninitialized(moves_triangles ? count : 0);
  TriangleRecord* records = moves_triangles ? scratch->records.data() : nullptr;
  executor.for_each(blocks.size(), 1, [&](std::size_t b) {
    scatter_keys(source, {scratch->keys.data() + blocks[b].begin, blocks[b].kept}, curve,
                 bucket_shift, scratch->counters.data() + b * buckets, scratch->sorted.data(),
                 records);
  });
  TaskMaker(executor, curve.id_bits, scratch).add(0, starts, 0, buckets);
  return {curve.id_bits, joins};
}

void sort_run(std::uint64_t* items, std::uint64_t* spare, std::uint32_t count,
              std::uint32_t id_bits) {
  if (count <= kFewItems) return std::sort(items, items + count);
  const std::uint64_t differing = differing_bits(items, count, items[0], id_bits);
  if (differing == 0) return;
  const auto width = static_cast<std::uint32_t>(std::bit_width(differing));
  const std::uint32_t low = width > kSortedBits ? width - kSortedBits : 0;
  sort_by_digits(items, spare, count, differing >> low << low);
  if (low > id_bits && !finish_sorting(items, count, id_bits))
    sort_by_digits(items, spare, count, differing);
}

}  // namespace raysheaf
