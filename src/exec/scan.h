// Prefix sums over 32-bit counts, and over flags that are computed on demand.
//
// Two passes over blocks of a fixed size: sums of the blocks, then every block from its own base
// (Blelloch 1990, "Prefix Sums and Their Applications", section 1.3). O(n) work; the input is read
// twice. The results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bits.h"
#include "base/view.h"
#include "exec/executor.h"

namespace raysheaf {

/// Items per task: 32 KiB of counts, which stay in a core's first-level cache between the two
/// passes.
inline constexpr std::size_t kScanBlock = 8192;

/// `out[i] = in[0] + ... + in[i - 1]`, so `out[0] = 0`. Returns the total, 0 for an empty input.
/// `in` may be `out`; other overlaps may not. Throws Error, `out` untouched, if the sizes differ or
/// the total is 2^32 or more.
std::uint32_t exclusive_scan(const Executor& executor, View<const std::uint32_t> in,
                             View<std::uint32_t> out);

/// The first pass of a scan over flags: how many are set, in all and before each block.
struct FlagCounts {
  std::vector<std::uint32_t> before_block;
  std::uint32_t total = 0;
};

/// Counts the i in [0, count) for which `flag(i)` is true; count < 2^32.
template <class Flag>
FlagCounts count_flags(const Executor& executor, std::size_t count, const Flag& flag) {
  FlagCounts counts;
  counts.before_block.resize(div_ceil(count, kScanBlock));
  executor.for_each(counts.before_block.size(), 1, [&](std::size_t block) {
    const std::size_t begin = block * kScanBlock;
    const std::size_t end = begin + kScanBlock < count ? begin + kScanBlock : count;
    std::uint32_t set = 0;
    for (std::size_t i = begin; i < end; ++i) set += flag(i) ? 1u : 0u;
    counts.before_block[block] = set;
  });
  counts.total = exclusive_scan(executor, counts.before_block, counts.before_block);
  return counts;
}

/// The second pass: calls `body(i, flag(i), s)` for each i, in any order, where `s` is the
/// inclusive scan of the flags at i. `flag` must return the same values as in the first pass; they
/// are not stored.
template <class Flag, class Body>
void for_each_scanned(const Executor& executor, const FlagCounts& counts, std::size_t count,
                      const Flag& flag, const Body& body) {
  executor.for_each(counts.before_block.size(), 1, [&](std::size_t block) {
    const std::size_t begin = block * kScanBlock;
    const std::size_t end = begin + kScanBlock < count ? begin + kScanBlock : count;
    std::uint32_t scanned = counts.before_block[block];
    for (std::size_t i = begin; i < end; ++i) {
      const bool set = flag(i);
      scanned += set ? 1u : 0u;
      body(i, set, scanned);
    }
  });
}

}  // namespace raysheaf
