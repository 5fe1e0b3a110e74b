// Runs every target on its seeds, on earlier findings, and on randomly mutated seeds: a substitute
// for libFuzzer (tools/fuzz) in builds without it. Any failure ends the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "fuzz/targets.h"
#include "support/process.h"
#include "support/random.h"

namespace raysheaf::fuzz {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

/// Sorted by name, so that the run is the same everywhere.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> all;
  if (!fs::is_directory(folder)) return all;
  for (const auto& entry : fs::directory_iterator(folder)) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

Bytes bytes_of(const fs::path& file) {
  const std::string text = test::read_file(file);
  return {text.begin(), text.end()};
}

fs::path fuzz_folder() {
  return fs::path(RAYSHEAF_SOURCE_DIR) / "tests/fuzz";
}

void change(test::Random* random, Bytes* bytes) {
  const auto size = static_cast<std::uint32_t>(bytes->size());
  if (size == 0) return;
  const auto at = static_cast<std::ptrdiff_t>(random->below(size));
  const auto count = static_cast<std::ptrdiff_t>(
      1 + random->below(std::min(16u, size - static_cast<std::uint32_t>(at))));
  switch (random->below(6)) {
    case 0:  // flips a bit
      (*bytes)[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1u << random->below(8));
      break;
    case 1:  // sets a byte with a special meaning
      (*bytes)[static_cast<std::size_t>(at)] =
          static_cast<std::uint8_t>("\0\xff\x7f\x80-9.e/\"{[,\n "[random->below(16)]);
      break;
    case 2:
      bytes->resize(static_cast<std::size_t>(at));
      break;
    case 3:
      bytes->erase(bytes->begin() + at, bytes->begin() + at + count);
      break;
    case 4: {  // repeats a part
      const Bytes part(bytes->begin() + at, bytes->begin() + at + count);
      bytes->insert(bytes->begin() + at, part.begin(), part.end());
      break;
    }
    default:  // inserts a large number
      for (std::ptrdiff_t i = 0; i < std::min<std::ptrdiff_t>(count, 4); ++i)
        (*bytes)[static_cast<std::size_t>(at + i)] = 0xff;
  }
}

class Fuzz : public ::testing::TestWithParam<Target> {
 protected:
  void SetUp() override { testing::internal::CaptureStderr(); }
  void TearDown() override { static_cast<void>(testing::internal::GetCapturedStderr()); }
};

TEST_P(Fuzz, SeedsAndWhatWasFound) {
  const auto seeds = files_in(fuzz_folder() / "seeds" / GetParam().name);
  EXPECT_FALSE(seeds.empty());
  for (const fs::path& file : seeds) GetParam().run(bytes_of(file));
  for (const fs::path& file : files_in(fuzz_folder() / "found" / GetParam().name))
    GetParam().run(bytes_of(file));
  GetParam().run({});
}

TEST_P(Fuzz, ChangedSeeds) {
  const int rounds = std::getenv("RAYSHEAF_LONG") != nullptr ? 30000 : 300;
  test::Random random(41);
  for (const fs::path& file : files_in(fuzz_folder() / "seeds" / GetParam().name)) {
    const Bytes seed = bytes_of(file);
    for (int round = 0; round < rounds; ++round) {
      Bytes bytes = seed;
      for (std::uint32_t times = 1 + random.below(6); times > 0; --times) change(&random, &bytes);
      GetParam().run(bytes);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, ::testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace raysheaf::fuzz
