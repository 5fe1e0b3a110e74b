// A stable counting sort in blocks, parallel in both of its passes (Satish, Harris, Garland 2009,
// "Designing Efficient Sorting Algorithms for Manycore GPUs", section 4).
//
//   block     0      1      2          places: bucket a is 0 to 4, bucket b is 5 to 7
//   items    a b a  b a a  a b         block 1 puts its a at 2 and 3, and its b at 6
//
// The caller stores the items, and decides to which buckets they belong.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/buffer.h"
#include "exec/executor.h"

namespace raysheaf {

/// Memory is kept from one sort to the next.
class BucketSort {
 public:
  /// The first pass. Calls `count_items(block, counts)` for each block, in parallel, which adds the
  /// number of the block's items in each bucket to counts[bucket]. At most 2^32 - 1 items in all.
  template <class CountItems>
  void count(const Executor& executor, std::size_t blocks, std::size_t buckets,
             const CountItems& count_items) {
    constexpr std::size_t kBucketGrain = 512;  // buckets per task, at least
    blocks_ = blocks;
    next_.resize_uninitialized(blocks * buckets);
    starts_.assign(buckets + 1, 0);
    executor.for_each(blocks, 1, [&](std::size_t block) {
      std::fill_n(row(block), buckets, 0u);
      count_items(block, row(block));
    });
    executor.for_each_block(buckets, kBucketGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t block = 0; block < blocks_; ++block) {
        std::uint32_t* const counts = row(block);
        for (std::size_t b = begin; b < end; ++b)
          starts_[b] += std::exchange(counts[b], starts_[b]);
      }
    });
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts_) sum += std::exchange(start, sum);
  }

  /// The place of each bucket's first item, and the number of all items.
  [[nodiscard]] const std::vector<std::uint32_t>& starts() const { return starts_; }

  /// The second pass, once after each first. Calls `put_items(block, next)` for each block, in
  /// parallel, which puts the block's items, in their order, at next[bucket]++.
  template <class PutItems>
  void put(const Executor& executor, const PutItems& put_items) {
    executor.for_each(blocks_, 1, [&](std::size_t block) {
      std::uint32_t* const next = row(block);
      for (std::size_t b = 0; b + 1 < starts_.size(); ++b) next[b] += starts_[b];
      put_items(block, next);
    });
  }

  [[nodiscard]] std::size_t bytes() const {
    return next_.capacity_bytes() + starts_.capacity() * sizeof(std::uint32_t);
  }

 private:
  [[nodiscard]] std::uint32_t* row(std::size_t block) const {
    return next_.data() + block * (starts_.size() - 1);
  }

  Buffer<std::uint32_t> next_;  ///< of each block, a row of buckets
  std::vector<std::uint32_t> starts_;
  std::size_t blocks_ = 0;
};

}  // namespace raysheaf
