#include "exec/scan.h"

#include <algorithm>
#include <limits>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// Sums of the blocks, each of at most 8192 * (2^32 - 1) < 2^45.
std::vector<std::uint64_t> block_sums(const Executor& executor, View<const std::uint32_t> in) {
  std::vector<std::uint64_t> sums(div_ceil(in.size, kScanBlock));
  executor.for_each(sums.size(), 1, [&](std::size_t block) {
    const std::size_t begin = block * kScanBlock;
    const std::size_t end = std::min(begin + kScanBlock, in.size);
    std::uint64_t sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += in.data[i];
    sums[block] = sum;
  });
  return sums;
}

/// Replaces each sum by the sum of all earlier blocks; returns the total.
std::uint32_t scan_blocks(std::vector<std::uint64_t>& sums) {
  std::uint64_t total = 0;
  for (std::uint64_t& sum : sums) {
    const std::uint64_t before = total;
    total += sum;
    if (total > std::numeric_limits<std::uint32_t>::max()) {
      throw Error(ErrorCode::kInvalidArgument, "the counts sum to 2^32 or more", "scan");
    }
    sum = before;
  }
  return static_cast<std::uint32_t>(total);
}

}  // namespace

std::uint32_t exclusive_scan(const Executor& executor, View<const std::uint32_t> in,
                             View<std::uint32_t> out) {
  if (in.size != out.size) {
    throw Error(ErrorCode::kInvalidArgument, "input and output differ in size", "scan");
  }
  std::vector<std::uint64_t> bases = block_sums(executor, in);
  const std::uint32_t total = scan_blocks(bases);
  executor.for_each(bases.size(), 1, [&](std::size_t block) {
    const std::size_t begin = block * kScanBlock;
    const std::size_t end = std::min(begin + kScanBlock, in.size);
    auto sum = static_cast<std::uint32_t>(bases[block]);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t before = sum;
      sum += in.data[i];
      out.data[i] = before;
    }
  });
  return total;
}

}  // namespace raysheaf
