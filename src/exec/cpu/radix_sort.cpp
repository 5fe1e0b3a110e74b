#include "exec/radix_sort.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <memory>
#include <utility>

#include "exec/bucket_sort.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// More buckets need fewer passes, but each costs a counter in every block (docs/order.md).
constexpr std::uint32_t kDigitBits = 11;
constexpr std::uint32_t kSmallDigitBits = 8;
constexpr std::size_t kSmall = 4096;

/// Blocks balance the load: a few per thread, each long enough to outweigh its row of counters.
constexpr std::size_t kBlocksAThread = 4;
constexpr std::size_t kMinBlock = 8192;

/// The `bits` bits of a key from bit `shift` up.
struct Digit {
  std::uint32_t shift;
  std::uint32_t bits;

  [[nodiscard]] std::uint32_t buckets() const { return 1u << bits; }
  template <class Key>
  [[nodiscard]] std::uint32_t operator()(Key key) const {
    return static_cast<std::uint32_t>(key >> shift) & (buckets() - 1);
  }
};

template <class Key>
struct Pair {
  Key key;
  std::uint32_t value;
};

/// Pairs as the caller stores them: two columns.
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

/// The fewest digits that cover the set bits, lowest first. No digit extends above the highest set
/// bit.
template <class Key>
std::vector<Digit> digits_over(Key bits, std::uint32_t most_bits) {
  std::vector<Digit> digits;
  while (bits != 0) {
    const auto shift = static_cast<std::uint32_t>(std::countr_zero(bits));
    const auto width = static_cast<std::uint32_t>(std::bit_width(static_cast<Key>(bits >> shift)));
    digits.push_back({shift, std::min(width, most_bits)});
    bits = width <= most_bits ? 0 : bits >> (shift + most_bits) << (shift + most_bits);
  }
  return digits;
}

/// One stable pass by a digit.
template <class Source, class Sink>
void sort_digit(const Executor& executor, Source in, Sink out, Blocks blocks, Digit digit,
                BucketSort& sort) {
  sort.count(executor, blocks.blocks, digit.buckets(),
             [&](std::size_t block, std::uint32_t* counts) {
               for (std::size_t i = blocks.begin(block); i < blocks.end(block); ++i)
                 ++counts[digit(in.key(i))];
             });
  sort.put(executor, [&](std::size_t block, std::uint32_t* next) {
    for (std::size_t i = blocks.begin(block); i < blocks.end(block); ++i) {
      const auto pair = in.get(i);
      out.put(next[digit(pair.key)]++, pair);
    }
  });
}

/// Columns to rows, rows to rows, rows to columns; with one digit, the last is a plain copy.
template <class Key>
void sort_digits(const Executor& executor, Columns<Key> columns, Blocks blocks,
                 const std::vector<Digit>& digits) {
  const auto near = std::make_unique_for_overwrite<Pair<Key>[]>(blocks.count);
  const auto far =
      std::make_unique_for_overwrite<Pair<Key>[]>(digits.size() > 2 ? blocks.count : 0);
  Rows<Key> rows{near.get()}, next{far.get()};
  BucketSort sort;
  sort_digit(executor, columns, rows, blocks, digits.front(), sort);
  for (std::size_t pass = 1; pass + 1 < digits.size(); ++pass) {
    sort_digit(executor, rows, next, blocks, digits[pass], sort);
    std::swap(rows, next);
  }
  if (digits.size() > 1) return sort_digit(executor, rows, columns, blocks, digits.back(), sort);
  executor.for_each(blocks.count, kMinBlock, [&](std::size_t i) { columns.put(i, rows.get(i)); });
}

template <class Key>
void sort_pairs(const Executor& executor, std::vector<Key>& keys,
                std::vector<std::uint32_t>& values, std::uint32_t key_bits) {
  if (keys.size() != values.size() || keys.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::kInvalidArgument, "keys and values must have the same size, below 2^32",
                "radix sort");
  }
  if (keys.size() < 2 || key_bits == 0) return;
  const std::uint32_t width = std::numeric_limits<Key>::digits;
  const Key compared = std::numeric_limits<Key>::max() >> (width - std::min(key_bits, width));
  const Columns<Key> columns{keys.data(), values.data()};
  const Blocks blocks(keys.size(), executor.threads());
  const Key bits = unsorted_bits(executor, columns, blocks, compared);
  const std::uint32_t most_bits = keys.size() < kSmall ? kSmallDigitBits : kDigitBits;
  if (bits != 0) sort_digits(executor, columns, blocks, digits_over(bits, most_bits));
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
