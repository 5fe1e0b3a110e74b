#include "exec/radix_sort.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <memory>

#include "base/bits.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

#ifndef DIGIT_BITS
#define DIGIT_BITS 8
#endif
#ifndef BLOCKS_A_THREAD
#define BLOCKS_A_THREAD 4
#endif
#ifndef MIN_BLOCK
#define MIN_BLOCK 8192
#endif
/// More buckets need fewer passes, until their write positions leave the first cache
/// (docs/order.md).
constexpr std::uint32_t kDigitBits = DIGIT_BITS;
/// Blocks are for balance: a few a thread, each long enough to outweigh its table of counts.
constexpr std::size_t kBlocksAThread = BLOCKS_A_THREAD;
constexpr std::size_t kMinBlock = MIN_BLOCK;

/// `bits` bits of a key from `shift` up, of those that `compared` keeps.
template <class Key>
struct Digit {
  Key compared;
  std::uint32_t shift;
  std::uint32_t bits;

  [[nodiscard]] std::uint32_t buckets() const { return 1u << bits; }
  [[nodiscard]] std::uint32_t operator()(Key key) const {
    return static_cast<std::uint32_t>((key & compared) >> shift) & (buckets() - 1);
  }
};

template <class Key>
struct Pair {
  Key key;
  std::uint32_t value;
};

/// Pairs as the caller has them: two columns.
template <class Key>
struct Columns {
  Key* keys;
  std::uint32_t* values;
  [[nodiscard]] Key key(std::size_t i) const { return keys[i]; }
  [[nodiscard]] Pair<Key> get(std::size_t i) const { return {keys[i], values[i]}; }
  void put(std::size_t i, Pair<Key> pair) const { keys[i] = pair.key, values[i] = pair.value; }
};

/// Pairs between passes: one row each, so that a scattered write touches one cache line, not two.
template <class Key>
struct Rows {
  Pair<Key>* pairs;
  [[nodiscard]] Key key(std::size_t i) const { return pairs[i].key; }
  [[nodiscard]] Pair<Key> get(std::size_t i) const { return pairs[i]; }
  void put(std::size_t i, Pair<Key> pair) const { pairs[i] = pair; }
};

/// A partition of [0, count) into equal blocks.
struct Blocks {
  std::size_t count;
  std::size_t blocks;

  Blocks(std::size_t n, std::uint32_t threads)
      : count(n), blocks(std::clamp<std::size_t>(n / kMinBlock, 1, kBlocksAThread * threads)) {}
  [[nodiscard]] std::size_t begin(std::size_t block) const { return count * block / blocks; }
  [[nodiscard]] std::size_t end(std::size_t block) const { return count * (block + 1) / blocks; }
};

/// The bits of `compared` in which keys differ; 0 if the keys are in order already.
template <class Key>
Key unsorted_bits(const Executor& executor, Columns<Key> in, Blocks blocks, Key compared) {
  std::atomic<Key> differing{0};
  std::atomic<bool> sorted{true};
  executor.for_each(blocks.blocks, 1, [&](std::size_t block) {
    const Key first = in.keys[0];
    Key differ = 0;
    std::uint32_t descents = 0;
    for (std::size_t i = std::max<std::size_t>(blocks.begin(block), 1); i < blocks.end(block);
         ++i) {
      differ |= in.keys[i] ^ first;
      descents |= (in.keys[i] & compared) < (in.keys[i - 1] & compared) ? 1u : 0u;
    }
    differing.fetch_or(differ & compared, std::memory_order_relaxed);
    if (descents != 0) sorted.store(false, std::memory_order_relaxed);
  });
  return sorted.load() ? 0 : differing.load();
}

/// The fewest digits that cover the set bits, lowest first.
template <class Key>
std::vector<Digit<Key>> digits_over(Key bits, Key compared) {
  std::vector<Digit<Key>> digits;
  while (bits != 0) {
    const auto shift = static_cast<std::uint32_t>(std::countr_zero(bits));
    const auto width = static_cast<std::uint32_t>(std::bit_width(static_cast<Key>(bits >> shift)));
    digits.push_back({compared, shift, std::min(width, kDigitBits)});
    bits = width <= kDigitBits ? 0 : bits >> (shift + kDigitBits) << (shift + kDigitBits);
  }
  return digits;
}

/// Where each block puts the first of its keys of each bucket: a row of buckets a block.
template <class Key, class Source>
void find_places(const Executor& executor, Source in, Blocks blocks, Digit<Key> digit,
                 std::vector<std::uint32_t>& places) {
  const std::size_t buckets = digit.buckets();
  places.assign(blocks.blocks * buckets, 0);
  executor.for_each(blocks.blocks, 1, [&](std::size_t block) {
    std::uint32_t* counts = &places[block * buckets];
    for (std::size_t i = blocks.begin(block); i < blocks.end(block); ++i)
      ++counts[digit(in.key(i))];
  });
  std::uint32_t place = 0;
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    for (std::size_t at = bucket; at < places.size(); at += buckets) {
      place += std::exchange(places[at], place);
    }
  }
}

/// One stable pass over a digit.
template <class Key, class Source, class Sink>
void sort_digit(const Executor& executor, Source in, Sink out, Blocks blocks, Digit<Key> digit,
                std::vector<std::uint32_t>& places) {
  find_places(executor, in, blocks, digit, places);
  executor.for_each(blocks.blocks, 1, [&](std::size_t block) {
    std::uint32_t* place = &places[block * digit.buckets()];
    for (std::size_t i = blocks.begin(block); i < blocks.end(block); ++i) {
      const Pair<Key> pair = in.get(i);
      out.put(place[digit(pair.key)]++, pair);
    }
  });
}

/// Columns to rows, rows to rows, rows to columns; with one digit, the last is a plain copy.
template <class Key>
void sort_digits(const Executor& executor, Columns<Key> columns, Blocks blocks,
                 const std::vector<Digit<Key>>& digits) {
  const auto near = std::make_unique_for_overwrite<Pair<Key>[]>(blocks.count);
  const auto far =
      std::make_unique_for_overwrite<Pair<Key>[]>(digits.size() > 2 ? blocks.count : 0);
  Rows<Key> rows{near.get()}, next{far.get()};
  std::vector<std::uint32_t> places;
  sort_digit(executor, columns, rows, blocks, digits.front(), places);
  for (std::size_t pass = 1; pass + 1 < digits.size(); ++pass) {
    sort_digit(executor, rows, next, blocks, digits[pass], places);
    std::swap(rows, next);
  }
  if (digits.size() > 1) return sort_digit(executor, rows, columns, blocks, digits.back(), places);
  executor.for_each(blocks.count, kMinBlock, [&](std::size_t i) { columns.put(i, rows.get(i)); });
}

template <class Key>
void sort_pairs(const Executor& executor, std::vector<Key>& keys,
                std::vector<std::uint32_t>& values, std::uint32_t key_bits) {
  if (keys.size() != values.size() || keys.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::kInvalidArgument,
                "keys and values must be equally many, fewer than 2^32", "radix sort");
  }
  if (keys.size() < 2 || key_bits == 0) return;
  const std::uint32_t width = std::numeric_limits<Key>::digits;
  const Key compared = std::numeric_limits<Key>::max() >> (width - std::min(key_bits, width));
  const Columns<Key> columns{keys.data(), values.data()};
  const Blocks blocks(keys.size(), executor.threads());
  const Key bits = unsorted_bits(executor, columns, blocks, compared);
  if (bits != 0) sort_digits(executor, columns, blocks, digits_over(bits, compared));
}

}  // namespace

void radix_sort_pairs(const Executor& executor, std::vector<std::uint32_t>& keys,
                      std::vector<std::uint32_t>& values, std::uint32_t key_bits) {
  sort_pairs(executor, keys, values, key_bits);
}

void radix_sort_pairs(const Executor& executor, std::vector<std::uint64_t>& keys,
                      std::vector<std::uint32_t>& values, std::uint32_t key_bits) {
  sort_pairs(executor, keys, values, key_bits);
}

}  // namespace raysheaf
