// The contract of exec/device.h for any device: tests/exec runs it on the CPU, tests/cuda on CUDA.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "exec/atomic.h"
#include "exec/bulk_links.h"
#include "exec/device.h"
#include "exec/executor.h"
#include "exec/stage_clock.h"
#include "tests/reference/ordering.h"
#include "tests/support/device_memory.h"

namespace raysheaf::test {

using reference::Words;

/// Sizes around the limits of warps, blocks and CUB's tiles.
inline constexpr std::size_t kDeviceSizes[] = {0,   1,    2,    31,   32,   33,   127,  128,
                                               129, 1023, 1024, 4097, 8191, 8192, 8193, 65537};

inline Words random_device_words(std::size_t count, std::uint32_t below, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::uint32_t> pick(0, below - 1);
  Words words(count);
  for (std::uint32_t& word : words) word = pick(random);
  return words;
}

template <class Device>
void expect_each_item_once(Device& device) {
  for (const std::size_t size : kDeviceSizes) {
    DeviceBuffer<std::uint32_t> seen = to_device(device, Words(size, 0u));
    const View<std::uint32_t> out = seen.view();
    device.for_each("each", size, [=] RAYSHEAF_DEVICE(std::size_t i) {
      out.data[i] += static_cast<std::uint32_t>(i) + 1;
    });
    Words expected(size);
    for (std::size_t i = 0; i < size; ++i) expected[i] = static_cast<std::uint32_t>(i) + 1;
    EXPECT_EQ(to_host(device, seen), expected) << size;
  }
}

template <class Device>
void expect_shared_words(Device& device) {
  constexpr std::size_t kCount = 50000;
  DeviceBuffer<std::uint32_t> low = to_device(device, Words{~0u, 0u, 0u});
  DeviceBuffer<std::uint64_t> wide =
      to_device(device, std::vector<std::uint64_t>{~std::uint64_t{0}, 0, 0});
  const View<std::uint32_t> words = low.view();
  const View<std::uint64_t> longs = wide.view();
  device.for_each("shared", kCount, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint64_t mixed = (i * 7919 + 13) % kCount;
    lower_to(&words.data[0], static_cast<std::uint32_t>(mixed + 5));
    lower_to(&longs.data[0], (mixed + 3) << 33);
    add_to(&longs.data[1], mixed << 20);
    arrive_at(&words.data[1]);
    add_to(&longs.data[2], exchange_at(&words.data[2], static_cast<std::uint32_t>(i) + 1));
  });
  const Words seen = to_host(device, low);
  const std::uint64_t sum = std::uint64_t{kCount} * (kCount - 1) / 2;
  EXPECT_EQ(seen, (Words{5, kCount, seen[2]}));
  // Each exchange returns the previous word, and the last word remains.
  EXPECT_EQ(to_host(device, wide), (std::vector<std::uint64_t>{std::uint64_t{3} << 33, sum << 20,
                                                               sum + kCount - seen[2]}));
}

template <class Device>
void expect_exclusive_scan(Device& device) {
  for (const std::size_t size : kDeviceSizes) {
    // Large enough for totals beyond 32 bits.
    const Words in = random_device_words(size, 0xf0000000u, static_cast<std::uint32_t>(size));
    std::vector<std::uint64_t> expected{0};
    for (const std::uint32_t x : in) expected.push_back(expected.back() + x);
    const DeviceBuffer<std::uint32_t> counts = to_device(device, in);
    DeviceBuffer<std::uint64_t> out(device.allocator());
    out.resize_uninitialized("scan", size + 1);
    device.exclusive_scan("scan", counts.view_const(), out.view());
    EXPECT_EQ(to_host(device, out), expected) << size;
    EXPECT_EQ(device.read("scan", out.data() + size), expected.back());
  }
}

template <class Device>
void expect_select(Device& device) {
  for (const std::size_t size : kDeviceSizes) {
    for (const std::uint32_t one_in : {1u, 2u, 50u, 1000000u}) {
      std::mt19937 random(one_in);
      std::vector<std::uint8_t> flags(size);
      Words expected;
      for (std::size_t i = 0; i < size; ++i) {
        flags[i] = random() % one_in == 0 ? static_cast<std::uint8_t>(1 + random() % 255) : 0;
        if (flags[i] != 0) expected.push_back(static_cast<std::uint32_t>(i));
      }
      const DeviceBuffer<std::uint8_t> in = to_device(device, flags);
      DeviceBuffer<std::uint32_t> out(device.allocator());
      out.resize_uninitialized("select", size);
      const std::uint32_t count = device.select("select", in.view_const(), out.view());
      ASSERT_EQ(count, expected.size()) << size;
      EXPECT_EQ(to_host(device, out.view(), count), expected) << size;
    }
  }
}

template <class Key, class Device>
void expect_stable_pairs(Device& device, const std::vector<Key>& keys, BitRange bits) {
  Words order(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto compared = [&](std::uint32_t i) {
    return reference::low_bits(static_cast<Key>(keys[i] >> bits.begin), bits.end - bits.begin);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return compared(a) < compared(b); });
  std::vector<Key> sorted;
  for (const std::uint32_t i : order) sorted.push_back(keys[i]);
  SortColumns<Key> columns(device.allocator());
  columns.resize_uninitialized("sort", keys.size(), true);
  Words values(keys.size());
  std::iota(values.begin(), values.end(), 0u);
  device.copy("sort", columns.keys.data(), keys.data(), keys.size() * sizeof(Key));
  device.copy("sort", columns.values.data(), values.data(), values.size() * sizeof(values[0]));
  device.sort_pairs("sort", &columns, bits);
  EXPECT_EQ(to_host(device, columns.keys), sorted) << keys.size();
  EXPECT_EQ(to_host(device, columns.values), order) << keys.size();
  if constexpr (sizeof(Key) == 8) {
    columns.resize_uninitialized("sort", keys.size(), false);
    device.copy("sort", columns.keys.data(), keys.data(), keys.size() * sizeof(Key));
    device.sort_keys("sort", &columns, bits);
    EXPECT_EQ(to_host(device, columns.keys), sorted) << keys.size() << " without values";
  }
}

template <class Key, class Device>
void expect_sorted(Device& device) {
  constexpr std::uint32_t kWidth = std::numeric_limits<Key>::digits;
  std::mt19937_64 random(5);
  for (const std::size_t size : kDeviceSizes) {
    std::vector<Key> keys(size);
    for (Key& key : keys) key = static_cast<Key>(random());
    expect_stable_pairs(device, keys, {0, kWidth});
    expect_stable_pairs(device, keys, {3, 17});
    for (Key& key : keys) key &= 7;  // many equal keys, which must keep their order
    expect_stable_pairs(device, keys, {0, kWidth});
    expect_stable_pairs(device, keys, {1, 2});
  }
  expect_stable_pairs(device, std::vector<Key>{3, 1, 2}, {4, 4});
}

template <class Device>
void expect_run_lengths(Device& device) {
  for (const std::size_t size : kDeviceSizes) {
    for (const std::uint32_t values : {1u, 2u, 1000u}) {
      const Words keys = random_device_words(size, values, 3);
      const std::vector<reference::Run> expected = reference::runs(keys);
      const DeviceBuffer<std::uint32_t> in = to_device(device, keys);
      DeviceBuffer<std::uint32_t> run_keys(device.allocator()), lengths(device.allocator());
      run_keys.resize_uninitialized("runs", size);
      lengths.resize_uninitialized("runs", size);
      const std::uint32_t count =
          device.run_lengths("runs", in.view_const(), {run_keys.view(), lengths.view()});
      ASSERT_EQ(count, expected.size()) << size;
      const Words found = to_host(device, run_keys.view(), count);
      const Words sizes = to_host(device, lengths.view(), count);
      for (std::size_t r = 0; r < count; ++r) {
        ASSERT_EQ(found[r], expected[r].key);
        ASSERT_EQ(sizes[r], expected[r].size);
      }
    }
  }
}

template <class Device>
void expect_moved_memory(Device& device) {
  const Words in = random_device_words(5000, 1u << 31, 1), order{4999, 0, 17, 17};
  const DeviceBuffer<std::uint32_t> from = to_device(device, in), places = to_device(device, order);
  DeviceBuffer<std::uint32_t> to(device.allocator());
  to.resize_uninitialized("gather", order.size());
  gather(device, "gather", from.view_const(), places.view_const(), to.view());
  EXPECT_EQ(to_host(device, to), (Words{in[4999], in[0], in[17], in[17]}));
  device.copy("copy", to.data() + 1, from.data(), sizeof in[0]);
  device.fill("fill", to.view().slice(2, 2), 0xab);
  EXPECT_EQ(to_host(device, to), (Words{in[4999], in[0], 0xababababu, 0xababababu}));
  EXPECT_TRUE(device.is_device_memory(to.data(), "words"));
  device.copy("nothing", nullptr, nullptr, 0);
  device.fill("nothing", View<std::uint32_t>(), 0);
}

template <class Device>
void expect_named_times(Device& device) {
  device.keep_times(true);
  DeviceBuffer<std::uint32_t> words(device.allocator());
  words.resize_uninitialized("first", 1000);
  for (int round = 0; round < 3; ++round) device.fill("first", words.view(), 1);
  device.for_each("second", 10, [] RAYSHEAF_DEVICE(std::size_t) {});
  const std::vector<StageTime> times = device.times();
  device.keep_times(false);
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].stage, "first");
  EXPECT_EQ(times[0].calls, 3u);
  EXPECT_EQ(times[1].stage, "second");
  EXPECT_EQ(times[1].calls, 1u);
  EXPECT_GE(times[0].ms, 0);
  device.fill("third", words.view(), 1);
  EXPECT_TRUE(device.times().empty());
}

template <class Device>
void expect_clock(Device& device) {
  DeviceBuffer<std::uint32_t> words(device.allocator());
  words.resize_uninitialized("clock", 1000);
  for (int round = 0; round < 2; ++round) {
    device.start_clock("clock");
    const double nothing = device.stop_clock("clock");
    EXPECT_GE(nothing, 0);
    device.start_clock("clock");
    for (int fill = 0; fill < 1000; ++fill) device.fill("clock", words.view(), 1);
    EXPECT_GT(device.stop_clock("clock"), nothing) << "of a thousand stages";
  }
}

/// The data of an uplink arrives after `see`, and not before: host buffer and device memory are
/// reused while all transfers are pending. The caller includes the device's `exec/links.h`.
template <class Device>
void expect_links(Device& device) {
  constexpr std::size_t kWords = 20000, kRounds = 7, kLanes = 2;
  constexpr std::size_t kBytes = kWords * sizeof(std::uint32_t);
  DeviceBuffer<std::uint32_t> sums = to_device(device, Words(kWords, 0u));
  std::vector<DeviceBuffer<std::uint32_t>> landings;
  for (std::size_t l = 0; l < kLanes; ++l)
    landings.push_back(to_device(device, Words(kWords, 1000u)));
  device.synchronize("links");
  {
    std::vector<std::unique_ptr<typename Device::Uplink>> uplinks;
    for (std::size_t l = 0; l < kLanes; ++l)
      uplinks.push_back(std::make_unique<typename Device::Uplink>(device));
    typename Device::Downlink downlink(device);
    for (std::uint32_t round = 0; round < kRounds; ++round) {
      auto& uplink = *uplinks[round % kLanes];
      std::byte* const room = uplink.room("links", kBytes);
      for (std::uint32_t i = 0; i < kWords; ++i) {
        const std::uint32_t word = i * (round + 1);
        std::memcpy(room + i * sizeof word, &word, sizeof word);
      }
      uplink.send("links", landings[round % kLanes].data(), kBytes);
      uplink.see("links");
      const View<std::uint32_t> sum = sums.view(), landed = landings[round % kLanes].view();
      device.for_each("links", kWords,
                      [=] RAYSHEAF_DEVICE(std::size_t i) { sum.data[i] += landed.data[i]; });
      uplink.done_with("links");
      downlink.ask("links", sums.data(), kBytes);
      if (round % 3 != 0) continue;
      const std::byte* const place = downlink.wait("links");
      std::uint32_t last = 0;
      std::memcpy(&last, place + kBytes - sizeof last, sizeof last);
      EXPECT_EQ(last, (kWords - 1) * (round + 1) * (round + 2) / 2) << round;
    }
    EXPECT_THROW(uplinks[0]->see("links"), Error);  // nothing was sent
    EXPECT_THROW(uplinks[0]->done_with("links"), Error);
    uplinks[0]->send("links", landings[0].data(), kBytes);
    EXPECT_THROW(uplinks[0]->send("links", landings[0].data(), kBytes), Error);
  }  // destroyed while all transfers are pending
  EXPECT_EQ(to_host(device, sums)[3], 3 * kRounds * (kRounds + 1) / 2);
  EXPECT_GT(device.free_bytes(), 0u);
}

/// Data sent in parts arrives and can be sent back, repeatedly; the sizes are zero, less than a
/// part, and whole parts with a remainder.
template <class Device>
void expect_bulk_links(Device& device) {
  constexpr std::size_t kPart = 30000 * sizeof(std::uint32_t);
  const Executor executor(3);
  BulkUplink<Device> uplink(device, kPart);
  BulkDownlink<Device> downlink(device, kPart);
  DeviceBuffer<std::uint32_t> there(device.allocator());
  for (const std::size_t count : {std::size_t{0}, std::size_t{7}, std::size_t{30000},
                                  std::size_t{100001}, std::size_t{90000}, std::size_t{1}}) {
    there.resize_uninitialized("bulk", count);
    const View<std::uint32_t> all = there.view();
    uplink.send("bulk", executor, all, [&](std::size_t begin, std::size_t end, std::uint32_t* out) {
      for (std::size_t i = begin; i < end; ++i) *out++ = static_cast<std::uint32_t>(3 * i + count);
    });
    device.for_each("bulk", count, [=] RAYSHEAF_DEVICE(std::size_t i) { all.data[i] += 1; });
    Words here(count), expected(count);
    for (std::size_t i = 0; i < count; ++i)
      expected[i] = static_cast<std::uint32_t>(3 * i + count + 1);
    downlink.fetch("bulk", executor, there.data(), View<std::uint32_t>(here));
    EXPECT_EQ(here, expected) << count;
  }
  // Cancelling while parts are written must not block the next transfer.
  std::atomic<bool> stop = true;
  there.resize_uninitialized("bulk", 100000);
  const auto ones = [](std::size_t begin, std::size_t end, std::uint32_t* out) {
    std::fill_n(out, end - begin, 1u);
  };
  EXPECT_THROW(uplink.send("bulk", executor.until(stop), there.view(), ones), Error);
  uplink.send("bulk", executor, there.view(), ones);
  EXPECT_EQ(to_host(device, there), Words(100000, 1u));
}

template <class Device>
void expect_all_verbs(Device& device) {
  expect_each_item_once(device);
  expect_shared_words(device);
  expect_exclusive_scan(device);
  expect_select(device);
  expect_sorted<std::uint32_t>(device);
  expect_sorted<std::uint64_t>(device);
  expect_run_lengths(device);
  expect_moved_memory(device);
  expect_named_times(device);
  expect_clock(device);
  expect_links(device);
  expect_bulk_links(device);
}

}  // namespace raysheaf::test
