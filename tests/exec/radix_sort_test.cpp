#include "exec/radix_sort.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "raysheaf/error.h"
#include "tests/reference/ordering.h"

namespace raysheaf {
namespace {

using reference::Words;

constexpr std::uint32_t kThreads[] = {1, 2, 7};

/// Sorts by the low `bits` bits with several numbers of threads; each must give the stable order.
template <class Key>
void expect_stable_order(const std::vector<Key>& keys, std::uint32_t bits,
                         const std::string& what) {
  const Words order = reference::stable_order(keys, bits);
  std::vector<Key> sorted;
  for (const std::uint32_t item : order) sorted.push_back(keys[item]);
  for (const std::uint32_t threads : kThreads) {
    std::vector<Key> result = keys;
    Words values(keys.size());
    std::iota(values.begin(), values.end(), 0u);
    radix_sort_pairs(Executor(threads), result, values, bits);
    ASSERT_TRUE(result == sorted) << what << ", " << threads << " threads: keys";
    ASSERT_TRUE(values == order) << what << ", " << threads << " threads: values";
  }
}

template <class Key>
class RadixSort : public testing::Test {
 protected:
  static constexpr std::uint32_t kWidth = std::numeric_limits<Key>::digits;

  std::vector<Key> random_keys(std::size_t count, Key mask = std::numeric_limits<Key>::max()) {
    std::vector<Key> keys(count);
    for (Key& key : keys) key = static_cast<Key>(random_()) & mask;
    return keys;
  }

  std::mt19937_64 random_{11};
};
using KeyTypes = testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(RadixSort, KeyTypes);

TYPED_TEST(RadixSort, AllLengthsNearTheBoundariesOfBlocks) {
  for (const std::size_t count : {0, 1, 2, 3, 255, 256, 257, 4095, 4096, 4097, 8191, 8192, 8193,
                                  16383, 16384, 16385, 65537, 7 * 4 * 8192 + 1, 300000}) {
    expect_stable_order(this->random_keys(count), this->kWidth, std::to_string(count) + " keys");
  }
}

TYPED_TEST(RadixSort, KeysThatDifferInSomeBits) {
  for (int round = 0; round < 40; ++round) {
    const auto mask = static_cast<TypeParam>(this->random_() & this->random_() & this->random_());
    std::vector<TypeParam> keys = this->random_keys(1 + this->random_() % 20000, mask);
    const auto common = static_cast<TypeParam>(this->random_()) & ~mask;
    for (TypeParam& key : keys) key |= common;
    expect_stable_order(keys, this->kWidth, "mask " + std::to_string(mask));
  }
}

TYPED_TEST(RadixSort, FewValuesKeepTheirOrder) {
  for (std::uint32_t shift = 0; shift + 5 <= this->kWidth; ++shift) {
    std::vector<TypeParam> keys = this->random_keys(5000, 31);
    for (TypeParam& key : keys) key = static_cast<TypeParam>(key << shift);
    expect_stable_order(keys, this->kWidth, "shift " + std::to_string(shift));
  }
}

TYPED_TEST(RadixSort, HighBitsAreCarriedNotCompared) {
  for (std::uint32_t bits = 0; bits <= this->kWidth; ++bits) {
    expect_stable_order(this->random_keys(9001), bits, std::to_string(bits) + " bits");
  }
}

TYPED_TEST(RadixSort, SortedEqualAndReversed) {
  constexpr std::size_t kCount = 65536;  // a multiple of the block size 8192
  std::vector<TypeParam> keys = this->random_keys(kCount);
  std::sort(keys.begin(), keys.end());
  expect_stable_order(keys, this->kWidth, "sorted");
  std::swap(keys[kCount / 2], keys[kCount / 2 + 1]);
  expect_stable_order(keys, this->kWidth, "sorted except one pair");
  std::sort(keys.begin(), keys.end());
  for (std::size_t at = 8192; at < kCount; at += 8192) {
    std::vector<TypeParam> broken = keys;
    std::swap(broken[at - 1], broken[at]);
    expect_stable_order(broken, this->kWidth, "a descent between blocks");
  }
  std::reverse(keys.begin(), keys.end());
  expect_stable_order(keys, this->kWidth, "reversed");
  expect_stable_order(std::vector<TypeParam>(kCount, 42), this->kWidth, "equal");
  keys.assign(kCount, std::numeric_limits<TypeParam>::max());
  keys.back() = 0;
  expect_stable_order(keys, this->kWidth, "the extremes");
}

TYPED_TEST(RadixSort, AnyValuesAreAllowed) {
  std::vector<TypeParam> keys{3, 1, 2, 1};
  Words values{0xffffffffu, 9, 9, 0};
  radix_sort_pairs(Executor(1), keys, values);
  EXPECT_EQ(keys, (std::vector<TypeParam>{1, 1, 2, 3}));
  EXPECT_EQ(values, (Words{9, 0, 9, 0xffffffffu}));
}

TYPED_TEST(RadixSort, RefusesColumnsOfDifferentLengths) {
  std::vector<TypeParam> keys{2, 1};
  Words values{0};
  EXPECT_THROW(radix_sort_pairs(Executor(1), keys, values), Error);
  EXPECT_EQ(keys, (std::vector<TypeParam>{2, 1}));
}

}  // namespace
}  // namespace raysheaf
