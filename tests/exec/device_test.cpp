#include "tests/exec/device_properties.h"

#include "emulated/emulated_links.h"
#include "support/guarded_memory.h"

namespace raysheaf::test {
namespace {

struct Emulated {
  explicit Emulated(std::uint32_t threads = 2, std::uint32_t most_blocks = 5)
      : executor(threads), memory(heap), device(executor, heap, &memory, most_blocks) {}

  Executor executor;
  test::GuardedMemory heap;
  FailingAllocator memory;
  EmulatedDevice device;
};

TEST(EmulatedDevice, KeepsTheContractOfDevices) {
  for (const std::uint32_t threads : {1u, 3u}) {
    Emulated emulated(threads, threads == 1 ? 1 : 64);
    expect_all_verbs(emulated.device);
    EXPECT_EQ(emulated.memory.alive(), 0u);
  }
}

TEST(Launch, GridsHoldEachItemOnce) {
  for (const std::uint32_t most : {1u, 2u, 3u, 1000u}) {
    for (const std::size_t count : kDeviceSizes) {
      const LaunchShape shape = launch_shape(count, most);
      ASSERT_LE(shape.blocks, most);
      ASSERT_EQ(shape.blocks == 0, count == 0) << "an empty grid is an error of CUDA's";
      if (shape.blocks < most) {
        ASSERT_LT(shape.stride(), count + shape.threads) << "idle blocks";
      }
      Words seen(count, 0u);
      for (std::size_t thread = 0; thread < shape.stride(); ++thread)
        for_items_of_thread(thread, shape.stride(), count, [&](std::size_t i) { ++seen[i]; });
      ASSERT_EQ(seen, Words(count, 1u)) << count << " items, at most " << most << " blocks";
    }
  }
}

TEST(Launch, CountsNearTheEndOfNumbersEnd) {
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  EXPECT_EQ(launch_shape(kMost, 1u << 20).blocks, 1u << 20);
  std::uint32_t calls = 0;
  for_items_of_thread(kMost - 3, std::size_t{1} << 40, kMost, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, 1u);
}

TEST(DeviceBuffer, GrowsAndNeverShrinks) {
  Emulated emulated;
  DeviceBuffer<std::uint32_t> buffer(emulated.memory);
  buffer.resize_uninitialized("test", 100);
  const std::uint32_t* const first = buffer.data();
  buffer.resize_uninitialized("test", 3);
  EXPECT_EQ(buffer.data(), first);
  EXPECT_EQ(buffer.size(), 3u);
  buffer.resize_uninitialized("test", 101);
  EXPECT_EQ(buffer.capacity_bytes(), 404u);
  EXPECT_EQ(emulated.memory.alive(), 1u);
  DeviceBuffer<std::uint32_t> other = std::move(buffer);
  EXPECT_EQ(other.size(), 101u);
  other.release();
  EXPECT_EQ(emulated.memory.alive(), 0u);
}

TEST(DeviceBuffer, MemoryThatRunsOutIsAnErrorOfItsStage) {
  Emulated emulated;
  DeviceBuffer<std::uint32_t> buffer(emulated.memory);
  buffer.resize_uninitialized("test", 8);
  emulated.memory.let(0);
  try {
    buffer.resize_uninitialized("keys of rays", 9);
    FAIL() << "there was memory";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
    EXPECT_EQ(error.place(), "keys of rays");
  }
  EXPECT_EQ(buffer.size(), 0u);
  EXPECT_EQ(emulated.memory.alive(), 0u);
  emulated.memory.let(FailingAllocator::kAlways);
  buffer.resize_uninitialized("test", 9);
  EXPECT_EQ(buffer.size(), 9u);
}

}  // namespace
}  // namespace raysheaf::test
