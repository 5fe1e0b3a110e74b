#include "paper/order/order.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "paper/order/order_body.h"
#include "raysheaf/error.h"
#include "render/rays/raygen.h"
#include "tests/reference/ordering.h"

namespace raysheaf {
namespace {

using reference::Words;

constexpr std::uint32_t kThreads[] = {1, 2, 7};

struct Stream {
  std::string name;
  Words keys;
};

/// Runs of random lengths below `longest`, with `values` different keys.
Words runs_of(std::size_t count, std::uint32_t longest, std::uint32_t values,
              std::mt19937& random) {
  Words keys;
  while (keys.size() < count) {
    const auto key = static_cast<std::uint32_t>(random() % values * 0x01003003u);
    const std::size_t length = std::min<std::size_t>(1 + random() % longest, count - keys.size());
    keys.insert(keys.end(), length, key);
  }
  return keys;
}

/// Degenerate streams, lengths near the limits of blocks, and random ones.
std::vector<Stream> streams() {
  std::mt19937 random(5);
  Words distinct(20000);
  std::iota(distinct.begin(), distinct.end(), 100u);
  std::shuffle(distinct.begin(), distinct.end(), random);
  std::vector<Stream> all{{"none", {}},
                          {"one", {7}},
                          {"two equal", {7, 7}},
                          {"two", {7, 3}},
                          {"all equal", Words(30000, 0xffffffffu)},
                          {"all distinct", distinct}};
  for (const std::size_t count : {8191, 8192, 8193, 16383, 16384, 16385, 24577}) {
    all.push_back({std::to_string(count) + " in runs", runs_of(count, 9000, 5, random)});
    all.push_back({std::to_string(count) + " mixed", runs_of(count, 4, 1000, random)});
  }
  all.push_back({"coarse", runs_of(300000, 64, 32, random)});
  all.push_back({"random", runs_of(300000, 1, 0xffffffffu, random)});
  return all;
}

std::vector<reference::Run> listed(const Chunks& chunks) {
  std::vector<reference::Run> runs;
  for (std::size_t i = 0; i < chunks.keys.size(); ++i) {
    runs.push_back({chunks.keys[i], chunks.bases[i], chunks.sizes[i]});
  }
  return runs;
}

TEST(Trim, KeepsTheSlotsWithRays) {
  std::mt19937 random(2);
  for (const std::uint32_t threads : kThreads) {
    const Executor executor(threads);
    for (const std::size_t count : {0, 1, 2, 8191, 8192, 8193, 16385, 300000}) {
      for (const std::uint32_t percent_empty : {0, 3, 50, 97, 100}) {
        std::vector<std::uint8_t> empty(count);
        for (auto& flag : empty)
          flag = static_cast<std::uint8_t>(random() % 100 < percent_empty ? 1 + random() % 255 : 0);
        const LargeVector<std::uint32_t> slots = trim(executor, empty);
        ASSERT_EQ(Words(slots.begin(), slots.end()), reference::trim(empty))
            << count << ", " << percent_empty;
      }
    }
  }
}

TEST(Compress, FindsTheRuns) {
  for (const Stream& stream : streams()) {
    for (const std::uint32_t threads : kThreads) {
      const Chunks chunks = compress(Executor(threads), stream.keys);
      ASSERT_EQ(chunks.ray_count, stream.keys.size()) << stream.name;
      ASSERT_TRUE(listed(chunks) == reference::runs(stream.keys)) << stream.name << threads;
    }
  }
}

TEST(Compress, ChunksCoverEveryRayOnceBeforeAndAfterTheSort) {
  const Executor executor(2);
  for (const Stream& stream : streams()) {
    Chunks chunks = compress(executor, stream.keys);
    for (const bool sorted : {false, true}) {
      Words covered(stream.keys.size(), 0u);
      for (const reference::Run& run : listed(chunks)) {
        ASSERT_GT(run.size, 0u);
        for (std::uint32_t ray = run.base; ray < run.base + run.size; ++ray) {
          ++covered.at(ray);
          ASSERT_EQ(stream.keys[ray], run.key);
        }
      }
      ASSERT_EQ(covered, Words(stream.keys.size(), 1u)) << stream.name << sorted;
      if (!sorted) sort_chunks(executor, chunks);
    }
  }
}

TEST(Decompress, UndoesCompress) {
  for (const Stream& stream : streams()) {
    Words identity(stream.keys.size());
    std::iota(identity.begin(), identity.end(), 0u);
    for (const std::uint32_t threads : kThreads) {
      const Executor executor(threads);
      Words permutation(stream.keys.size(), 0xdeadu);
      decompress(executor, compress(executor, stream.keys), permutation);
      ASSERT_EQ(permutation, identity) << stream.name;
    }
  }
}

TEST(Decompress, RefusesChunksThatAreNotTheRays) {
  const Executor executor(1);
  const Words keys{1, 1, 2};
  Chunks chunks = compress(executor, keys);
  Words short_one(2), right(3);
  EXPECT_THROW(decompress(executor, chunks, short_one), Error);
  chunks.sizes[0] = 1;
  EXPECT_THROW(decompress(executor, chunks, right), Error);
  chunks.sizes[0] = 0xffffffffu;
  EXPECT_THROW(decompress(executor, chunks, right), Error);
}

TEST(SortChunks, IsStableAndKeepsEachChunkWhole) {
  const Executor executor(2);
  for (const Stream& stream : streams()) {
    const std::vector<reference::Run> runs = reference::runs(stream.keys);
    Words keys;
    for (const reference::Run& run : runs) keys.push_back(run.key);
    Chunks chunks = compress(executor, stream.keys);
    sort_chunks(executor, chunks);
    std::vector<reference::Run> expected;
    for (const std::uint32_t i : reference::stable_order(keys, 32)) expected.push_back(runs[i]);
    ASSERT_TRUE(listed(chunks) == expected) << stream.name;
  }
}

TEST(OrderByKey, IsTheStableOrder) {
  for (const Stream& stream : streams()) {
    for (const std::uint32_t bits : {32u, 24u, 12u, 1u, 0u}) {
      const Words expected = reference::stable_order(stream.keys, bits);
      for (const std::uint32_t threads : kThreads) {
        Words permutation(stream.keys.size(), 0xdeadu);
        const std::uint32_t chunks =
            order_by_key(Executor(threads), stream.keys, permutation, bits);
        ASSERT_EQ(chunks, reference::runs(stream.keys).size()) << stream.name;
        ASSERT_TRUE(permutation == expected) << stream.name << ", " << bits << " bits, " << threads;
      }
    }
  }
}

TEST(OrderByKey, RefusesAPermutationOfAnotherSize) {
  const Words keys{1, 2, 3};
  Words permutation(4);
  EXPECT_THROW(order_by_key(Executor(1), keys, permutation), Error);
}

TEST(OrderBody, TheChunkAtAPlaceIsTheLastThatStartsThere) {
  std::mt19937 random(9);
  for (std::uint32_t count = 1; count < 70; ++count) {
    Words starts{0};
    while (starts.size() < count)
      starts.push_back(starts.back() + static_cast<std::uint32_t>(random() % 3));
    for (std::uint32_t place = 0; place < starts.back() + 3; ++place) {
      std::uint32_t expected = 0;
      for (std::uint32_t i = 0; i < count; ++i) expected = starts[i] <= place ? i : expected;
      ASSERT_EQ(chunk_at(starts.data(), count, place), expected);
    }
  }
}

}  // namespace
}  // namespace raysheaf
