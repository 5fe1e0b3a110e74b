#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/curve_order.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/triangle_reader.h"

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

/// Columns of centres are read in vectors.
constexpr std::uint32_t kColumnPadding = 64;

/// Strips are joined if that leaves at most this many per triangle, and leaves if their quads would
/// be at most this many per triangle.
constexpr double kMostStrips = 0.45, kMostQuads = 0.3;
/// The room for strips that are leaves of their own, in addition to the other quads: one in so
/// many.
constexpr std::uint32_t kStripRoom = 8;

/// Consecutive items.
struct Block {
  std::uint32_t first = 0, items = 0;  ///< places of their centres
  std::uint32_t kept = 0, jumps = 0;
  Box centers;
  std::vector<std::uint32_t> left_out;

  Block() = default;
  Block(std::uint32_t begin, std::uint32_t count) : first(begin), items(count) {}
};

/// All items that have a key.
struct Items {
  std::vector<Block> blocks;
  CenterColumns centers;
  std::uint32_t places = 0;  ///< of centres
};

/// The begins of blocks of [0, count), and the end.
std::vector<std::uint32_t> block_begins(std::uint32_t count) {
  const std::uint32_t blocks = std::clamp(count / kMinSortBlock, 1u, kMostSortBlocks);
  std::vector<std::uint32_t> begins(blocks + 1);
  for (std::uint32_t b = 0; b <= blocks; ++b)
    begins[b] = static_cast<std::uint32_t>(std::uint64_t{count} * b / blocks);
  return begins;
}

/// Calls `body(begin, end)` for blocks of [0, count) in parallel; returns the results.
template <class Body>
std::vector<Block> for_each_block(const Executor& executor, std::uint32_t count, const Body& body) {
  const std::vector<std::uint32_t> begins = block_begins(count);
  std::vector<Block> blocks(begins.size() - 1);
  executor.for_each(blocks.size(), 1,
                    [&](std::size_t b) { blocks[b] = body(begins[b], begins[b + 1]); });
  return blocks;
}

CenterColumns columns_of(TreeScratch* scratch, std::uint32_t count) {
  const std::size_t column = count + kColumnPadding;
  scratch->centers.resize_uninitialized(3 * column);
  float* const x = scratch->centers.data();
  return {{x, x + column, x + 2 * column}};
}
CenterColumns from(CenterColumns centers, std::uint32_t place) {
  return {{centers.axis[0] + place, centers.axis[1] + place, centers.axis[2] + place}};
}

Items measure_triangles(const Executor& executor, const TriangleSource& source, bool keep_flat,
                        TreeScratch* scratch) {
  const CenterColumns centers = columns_of(scratch, source.count);
  const auto measure = [&](std::uint32_t begin, std::uint32_t end) {
    Block block(begin, end - begin);
    measure_centers(source, begin, end, centers, &block.centers,
                    keep_flat ? nullptr : &block.left_out);
    return block;
  };
  return {for_each_block(executor, source.count, measure), centers, source.count};
}

Items join_strips(const Executor& executor, const TriangleSource& source, bool keep_flat,
                  TreeScratch* scratch) {
  const CenterColumns centers = columns_of(scratch, source.count);
  scratch->strips.resize_uninitialized(source.count);
  const auto join = [&](std::uint32_t begin, std::uint32_t end) {
    Block block(begin, 0);
    block.items =
        join_triangles(source, begin, end, from(centers, begin), scratch->strips.data() + begin,
                       &block.centers, keep_flat ? nullptr : &block.left_out);
    return block;
  };
  return {for_each_block(executor, source.count, join), centers, source.count};
}

/// The last triangle up to `number` whose quad begins with it, as counted from the run's first.
std::uint32_t first_of_four(const TriangleSource& source, std::uint32_t number) {
  const std::uint32_t first = source.runs[source.run_of(number)].first;
  return number - (number - first) % kQuadTriangles;
}

Items join_leaves(const Executor& executor, const TriangleSource& source,
                  const TreeOptions& options, ObjectTree* tree) {
  std::vector<std::uint32_t> begins = block_begins(source.count);
  for (std::size_t b = 1; b + 1 < begins.size(); ++b) begins[b] = first_of_four(source, begins[b]);
  std::vector<std::uint32_t> first_quads(begins.size());
  for (std::size_t b = 1; b < begins.size(); ++b)
    first_quads[b] = first_quads[b - 1] + count_quads(source, begins[b - 1], begins[b]);
  const std::uint32_t quads = first_quads.back();
  Buffer<AreaItem>& leaves = tree->scratch.source_leaves;
  CenterColumns centers;
  std::vector<SourceLeaves> found;
  std::vector<std::uint32_t> strips;
  const auto join = [&](std::size_t room) {
    tree->quads.resize_uninitialized(room);
    leaves.resize_uninitialized(room);
    centers = columns_of(&tree->scratch, static_cast<std::uint32_t>(room));
    found.assign(begins.size() - 1, {});
    executor.for_each(found.size(), 1, [&](std::size_t b) {
      write_source_leaves(source, begins[b], begins[b + 1], options.leaf_triangles / kQuadTriangles,
                          options.keep_flat, first_quads[b], tree->quads.data(), centers,
                          leaves.data(), &found[b]);
    });
    strips.clear();
    for (const SourceLeaves& each : found)
      strips.insert(strips.end(), each.strips.begin(), each.strips.end());
  };
  const std::size_t least = quads + quads / kStripRoom, most = std::size_t{2} * quads;
  join(std::clamp(tree->quads.capacity(), least, most));
  if (quads + strips.size() > tree->quads.size()) join(quads + strips.size());
  tree->quads.resize_uninitialized(quads + strips.size());

  std::vector<Block> blocks(found.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    blocks[b] = Block(first_quads[b], found[b].count);
    blocks[b].centers = found[b].bounds;
    blocks[b].left_out = std::move(found[b].left_out);
  }
  const auto write = [&](std::uint32_t begin, std::uint32_t end) {
    Block block(quads + begin, end - begin);
    block.centers = write_strip_leaves(source, {strips.data() + begin, end - begin}, block.first,
                                       tree->quads.data(), centers, leaves.data());
    return block;
  };
  if (!strips.empty()) {
    std::vector<Block> others =
        for_each_block(executor, static_cast<std::uint32_t>(strips.size()), write);
    blocks.insert(blocks.end(), std::make_move_iterator(others.begin()),
                  std::make_move_iterator(others.end()));
  }
  return {std::move(blocks), centers, static_cast<std::uint32_t>(tree->quads.size())};
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
std::uint64_t differing_bits(View<const std::uint64_t> items, std::uint64_t first,
                             std::uint32_t id_bits) {
  std::uint64_t differing = 0;
  for (const std::uint64_t item : items) differing |= item ^ first;
  return differing >> id_bits << id_bits;
}

/// The boxes of a curve's items.
class ItemBoxes {
 public:
  ItemBoxes(const TriangleSource& source, const CurveItems& curve, const TreeScratch& scratch)
      : reader_(source), curve_(curve), scratch_(scratch) {}

  [[nodiscard]] Box of(std::uint32_t item) {
    if (curve_.joining == Joining::kLeaves) {
      const AreaItem& leaf = scratch_.source_leaves[item];
      return {leaf.min, leaf.max};
    }
    const bool is_strip = curve_.joining == Joining::kStrips;
    const bool is_record = scratch_.records.size() != 0;
    const std::uint32_t first = is_strip    ? item >> kStripBits
                                : is_record ? scratch_.records[item].id
                                            : item;
    const std::uint32_t last = first + (is_strip ? item % (1u << kStripBits) : 0);
    Box box;
    for (std::uint32_t id = first; id <= last; ++id)
      for (const Vec3* p : reader_.corners(id).p) box = {min(box.min, *p), max(box.max, *p)};
    return box;
  }

 private:
  TriangleReader reader_;
  const CurveItems& curve_;
  const TreeScratch& scratch_;
};

/// Makes tasks from buckets of `scratch->sorted`.
class TaskMaker {
 public:
  TaskMaker(const Executor& executor, const TriangleSource& source, const CurveItems& curve,
            TreeScratch* scratch)
      : executor_(executor),
        source_(source),
        curve_(curve),
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
    const auto block_of = [&](std::size_t block) {
      const std::uint32_t begin = static_cast<std::uint32_t>(block) * kMinSortBlock;
      return View<const std::uint64_t>(items + begin, std::min(count - begin, kMinSortBlock));
    };
    const auto differing_here = [&] {
      std::atomic<std::uint64_t> differ{0};
      executor_.for_each(blocks, 1, [&](std::size_t block) {
        differ.fetch_or(differing_bits(block_of(block), items[0], curve_.id_bits),
                        std::memory_order_relaxed);
      });
      return differ.load();
    };
    std::uint64_t differing = differing_here();
    if (differing == 0) {
      if (!refine_keys(executor_, source_, curve_, scratch_, items, count))
        return scratch_.tasks.push_back({first, count});
      differing = differing_here();
    }
    const auto width = static_cast<std::uint32_t>(std::bit_width(differing));
    const std::uint32_t bits = std::min(kDividingBits, width - curve_.id_bits);
    const std::uint32_t shift = width - bits;
    const std::size_t buckets = std::size_t{1} << bits;
    const auto bucket_of = [&](std::uint64_t item) { return (item >> shift) & (buckets - 1); };
    BucketSort sort;
    sort.count(executor_, blocks, buckets, [&](std::size_t block, std::uint32_t* counts) {
      for (const std::uint64_t item : block_of(block)) ++counts[bucket_of(item)];
    });
    sort.put(executor_, [&](std::size_t block, std::uint32_t* next) {
      for (const std::uint64_t item : block_of(block)) spare[next[bucket_of(item)]++] = item;
    });
    executor_.for_each(count, kMinSortBlock, [&](std::size_t i) { items[i] = spare[i]; });
    add(first, sort.starts(), 0, buckets);
  }

  const Executor& executor_;
  const TriangleSource& source_;
  const CurveItems& curve_;
  std::uint32_t most_;
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

Joining joining_of(const TriangleSource& source) {
  constexpr std::uint32_t kWindows = 32, kLength = 64;
  if (source.count == 0 || source.count > UINT32_MAX >> kStripBits) return Joining::kNone;
  float columns[3][kLength];
  const CenterColumns centers{{columns[0], columns[1], columns[2]}};
  const std::uint32_t windows = std::clamp(source.count / kLength, 1u, kWindows);
  double strips = 0, quads = 0, all = 0;
  for (std::uint32_t w = 0; w < windows; ++w) {
    const std::uint32_t begin = first_of_four(
        source, static_cast<std::uint32_t>(std::uint64_t{source.count} * w / windows));
    const std::uint32_t end = std::min(begin + kLength, source.count);
    TriangleQuad room[kLength];
    AreaItem leaves[kLength];
    SourceLeaves found;
    write_source_leaves(source, begin, end, 1, false, 0, room, centers, leaves, &found);
    quads += static_cast<double>(found.count + found.strips.size());
    std::uint32_t words[kLength];
    Box bounds;
    strips += join_triangles(source, begin, end, centers, words, &bounds, &found.left_out);
    all += end - begin;
  }
  if (quads <= kMostQuads * all) return Joining::kLeaves;
  return strips <= kMostStrips * all ? Joining::kStrips : Joining::kNone;
}

CurveItems bucket_along_curve(const Executor& executor, const TriangleSource& source,
                              Joining joining, const TreeOptions& options, ObjectTree* tree) {
  TreeScratch* const scratch = &tree->scratch;
  tree->left_out.clear();
  scratch->tasks.clear();
  if (source.count == 0) return {joining, 0};
  const bool keep_flat = options.keep_flat;
  Items all = joining == Joining::kLeaves ? join_leaves(executor, source, options, tree)
              : joining == Joining::kStrips
                  ? join_strips(executor, source, keep_flat, scratch)
                  : measure_triangles(executor, source, keep_flat, scratch);
  std::vector<Block>& blocks = all.blocks;
  Box bounds;
  std::uint32_t items = 0;
  for (const Block& block : blocks) {
    items += block.items;
    bounds.min = min(bounds.min, block.centers.min);
    bounds.max = max(bounds.max, block.centers.max);
    tree->left_out.insert(tree->left_out.end(), block.left_out.begin(), block.left_out.end());
  }
  const MortonCurve curve = curve_through(
      bounds, std::max(1u, bits_for(all.places)) + (joining == Joining::kStrips ? kStripBits : 0));
  const std::uint32_t bucket_bits =
      std::min({kMostBucketBits, 3 * curve.bits, std::max(8u, bits_for(items)) - 8});
  const std::size_t buckets = std::size_t{1} << bucket_bits;
  const std::uint32_t bucket_shift = 3 * curve.bits - bucket_bits;
  const std::uint32_t* const strips =
      joining == Joining::kStrips ? scratch->strips.data() : nullptr;
  scratch->keys.resize_uninitialized(all.places);
  scratch->sorted.resize_uninitialized(items);
  scratch->sort.count(executor, blocks.size(), buckets, [&](std::size_t b, std::uint32_t* counts) {
    Block& block = blocks[b];
    std::uint64_t* const keys = scratch->keys.data() + block.first;
    block.kept = write_keys(all.centers, strips, curve, block.first, block.first + block.items,
                            bucket_shift, keys, counts);
    block.jumps = jumps_between({keys, block.kept}, curve.id_bits + bucket_shift);
  });
  const bool moves_triangles = joining == Joining::kNone && in_no_order(blocks);
  scratch->records.resize_uninitialized(moves_triangles ? source.count : 0);
  TriangleRecord* records = moves_triangles ? scratch->records.data() : nullptr;
  scratch->sort.put(executor, [&](std::size_t b, std::uint32_t* next) {
    scatter_keys(source, {scratch->keys.data() + blocks[b].first, blocks[b].kept}, curve,
                 bucket_shift, next, scratch->sorted.data(), records);
  });
  const CurveItems sorted{joining, curve.id_bits};
  TaskMaker(executor, source, sorted, scratch).add(0, scratch->sort.starts(), 0, buckets);
  return sorted;
}

bool refine_keys(const Executor& executor, const TriangleSource& source, const CurveItems& curve,
                 const TreeScratch& scratch, std::uint64_t* items, std::uint32_t count) {
  const std::uint32_t blocks = div_ceil(count, kMinSortBlock), column = count + kColumnPadding;
  std::vector<float> room(std::size_t{3} * column);
  const CenterColumns centers{{room.data(), room.data() + column, room.data() + 2 * column}};
  std::vector<std::uint32_t> numbers(count);
  std::vector<Box> bounds(blocks);
  const auto begin_of = [&](std::size_t block) {
    return std::min(count, static_cast<std::uint32_t>(block) * kMinSortBlock);
  };
  executor.for_each(blocks, 1, [&](std::size_t block) {
    ItemBoxes boxes(source, curve, scratch);
    Box all;
    for (std::uint32_t i = begin_of(block); i < begin_of(block + 1); ++i) {
      numbers[i] = static_cast<std::uint32_t>(items[i] & ((std::uint64_t{1} << curve.id_bits) - 1));
      const Box box = boxes.of(numbers[i]);
      const Vec3 center = box.min + box.max;
      for (int axis = 0; axis < 3; ++axis) centers.axis[axis][i] = component(center, axis);
      all = {min(all.min, center), max(all.max, center)};
    }
    bounds[block] = all;
  });
  Box all;
  for (const Box& box : bounds) all = {min(all.min, box.min), max(all.max, box.max)};
  const MortonCurve refined = curve_through(all, curve.id_bits);
  if (refined.scale == 0) return false;
  executor.for_each(blocks, 1, [&](std::size_t block) {
    std::uint32_t written = 0;
    write_keys(centers, numbers.data(), refined, begin_of(block), begin_of(block + 1),
               3 * refined.bits, items + begin_of(block), &written);
  });
  return true;
}

void sort_run(std::uint64_t* items, std::uint64_t* spare, std::uint32_t count,
              std::uint32_t id_bits) {
  if (count <= kFewItems) return std::sort(items, items + count);
  const std::uint64_t differing = differing_bits({items, count}, items[0], id_bits);
  if (differing == 0) return;
  const auto width = static_cast<std::uint32_t>(std::bit_width(differing));
  const std::uint32_t low = width > kSortedBits ? width - kSortedBits : 0;
  sort_by_digits(items, spare, count, differing >> low << low);
  if (low > id_bits && !finish_sorting(items, count, id_bits))
    sort_by_digits(items, spare, count, differing);
}

}  // namespace raysheaf
