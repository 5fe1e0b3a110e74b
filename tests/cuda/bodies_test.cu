// Each device function gives the same bits on the device as on the host.
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "cuda/compiled_cases.h"

namespace raysheaf::test {

/// GoogleTest would otherwise print addresses in the tests' names.
inline void PrintTo(const CompiledCase& compiled, std::ostream* out) {
  *out << compiled.name;
}

namespace {

constexpr std::uint32_t kItems = 100000, kThreads = 128;

bool has_device() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}

std::vector<Words> words_from_device(const CompiledCase& compiled) {
  std::vector<Words> out(kItems);
  const std::size_t bytes = kItems * sizeof(Words);
  Words* there = nullptr;
  EXPECT_EQ(cudaMalloc(&there, bytes), cudaSuccess);
  EXPECT_EQ(cudaMemcpy(there, out.data(), bytes, cudaMemcpyHostToDevice), cudaSuccess);
  compiled.on_device<<<div_ceil(kItems, kThreads), kThreads>>>(kItems, there);
  EXPECT_EQ(cudaGetLastError(), cudaSuccess);
  EXPECT_EQ(cudaMemcpy(out.data(), there, bytes, cudaMemcpyDeviceToHost), cudaSuccess);
  EXPECT_EQ(cudaFree(there), cudaSuccess);
  return out;
}

class Bodies : public testing::TestWithParam<CompiledCase> {};

TEST_P(Bodies, FitTheirWordsAndDependOnTheirInput) {
  std::vector<Words> out(1000);
  GetParam().on_host(1000, out.data());
  std::uint32_t unlike_the_first = 0;
  for (const Words& words : out) {
    ASSERT_GT(words.count, 0u);
    ASSERT_LE(words.count, Words::kRoom);
    if (!(words == out[0])) ++unlike_the_first;
  }
  EXPECT_GT(unlike_the_first, 100u);
}

TEST_P(Bodies, GiveTheSameBitsOnTheDevice) {
  if (!has_device()) GTEST_SKIP() << "there is no CUDA device";
  std::vector<Words> expected(kItems);
  GetParam().on_host(kItems, expected.data());
  const std::vector<Words> actual = words_from_device(GetParam());
  std::uint32_t different = 0;
  for (std::uint32_t i = 0; i < kItems; ++i) {
    if (actual[i] == expected[i]) continue;
    if (++different <= 5) {
      ADD_FAILURE() << "item " << i << ", word " << first_difference(actual[i], expected[i]);
    }
  }
  EXPECT_EQ(different, 0u);
}

std::string name_of(const testing::TestParamInfo<CompiledCase>& tested) {
  return tested.param.name;
}

INSTANTIATE_TEST_SUITE_P(Stages, Bodies, testing::ValuesIn(compiled_stage_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Bounds, Bodies, testing::ValuesIn(compiled_bound_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Packets, Bodies, testing::ValuesIn(compiled_packet_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Trees, Bodies, testing::ValuesIn(compiled_tree_cases()), name_of);

}  // namespace
}  // namespace raysheaf::test
