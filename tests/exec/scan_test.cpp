#include "exec/scan.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "raysheaf/error.h"
#include "tests/reference/ordering.h"

namespace raysheaf {
namespace {

using reference::Words;

constexpr std::uint32_t kScanThreads[] = {1, 2, 7};
constexpr std::size_t kSizes[] = {0,     1,     2,     63,    8191,         8192,  8193,
                                  16383, 16384, 16385, 81920, 3 * 8192 + 5, 300000};

Words random_words(std::size_t count, std::uint32_t below, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::uint32_t> pick(0, below - 1);
  Words words(count);
  for (std::uint32_t& word : words) word = pick(random);
  return words;
}

TEST(Scan, EqualsTheReference) {
  for (const std::uint32_t threads : kScanThreads) {
    const Executor executor(threads);
    for (const std::size_t size : kSizes) {
      const Words in = random_words(size, 1000, static_cast<std::uint32_t>(size));
      Words out(size, 0xdeadu);
      EXPECT_EQ(exclusive_scan(executor, in, out),
                size == 0 ? 0 : reference::inclusive_scan(in).back());
      EXPECT_EQ(out, reference::exclusive_scan(in)) << size << " items, " << threads << " threads";
    }
  }
}

TEST(Scan, InputMayBeOutput) {
  for (const std::uint32_t threads : kScanThreads) {
    const Executor executor(threads);
    const Words in = random_words(50001, 7, 3);
    Words both = in;
    exclusive_scan(executor, both, both);
    EXPECT_EQ(both, reference::exclusive_scan(in));
  }
}

TEST(Scan, TotalsReachTheLastCountAndNoFurther) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  for (const std::uint32_t threads : kScanThreads) {
    const Executor executor(threads);
    Words in(65536, 65535u);  // the sum is 2^32 - 2^16
    in.push_back(65535u);     // now it is 2^32 - 1
    Words out(in.size(), 1u);
    EXPECT_EQ(exclusive_scan(executor, in, out), kMost);
    EXPECT_EQ(out.back(), kMost - 65535u);
    in.push_back(1u);
    out.assign(in.size(), 77u);
    EXPECT_THROW(exclusive_scan(executor, in, out), Error);
    EXPECT_EQ(out, Words(in.size(), 77u)) << "a refused scan writes nothing";
  }
}

TEST(Scan, RefusesOutputOfAnotherSize) {
  const Executor executor(1);
  const Words in(5, 1u);
  Words out(4);
  EXPECT_THROW(exclusive_scan(executor, in, out), Error);
}

TEST(ScanOfFlags, CallsEachItemOnceWithItsInclusiveSum) {
  for (const std::uint32_t threads : kScanThreads) {
    const Executor executor(threads);
    for (const std::size_t size : kSizes) {
      const Words flags = random_words(size, 2, 5 + static_cast<std::uint32_t>(size));
      const Words expected = reference::inclusive_scan(flags);
      const auto flag = [&](std::size_t i) { return flags[i] != 0; };
      const FlagCounts counts = count_flags(executor, size, flag);
      EXPECT_EQ(counts.total, size == 0 ? 0 : expected.back());
      Words sums(size, 0u), seen(size, 0u), set(size, 2u);
      for_each_scanned(executor, counts, size, flag,
                       [&](std::size_t i, bool is_set, std::uint32_t sum) {
                         sums[i] = sum;
                         set[i] = is_set ? 1u : 0u;
                         ++seen[i];
                       });
      EXPECT_EQ(sums, expected);
      EXPECT_EQ(set, flags);
      EXPECT_EQ(seen, Words(size, 1u));
    }
  }
}

}  // namespace
}  // namespace raysheaf
