#include "paper/packets/packets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/random.h"

namespace raysheaf {
namespace {

using Words = std::vector<std::uint32_t>;

struct Cut {
  std::vector<Packet> packets;
  Words order;
};

Cut cut(const std::vector<Ray>& rays, const Words& keys, std::uint32_t most_rays,
        std::uint32_t threads = 2, std::uint32_t key_bits = 32) {
  Cut result;
  result.order.resize(rays.size());
  std::iota(result.order.begin(), result.order.end(), 0u);
  result.packets = make_packets(Executor(threads), rays, keys, key_bits, most_rays, result.order);
  return result;
}

std::vector<Ray> random_rays(std::uint32_t count, std::uint64_t seed, bool one_sense) {
  test::Random random(seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.direction = one_sense ? Vec3{0, -1, 0} : random.direction();
    ray.origin = random.in_box(1);
  }
  return rays;
}

Words random_keys(std::uint32_t count, std::uint32_t values, std::uint64_t seed) {
  test::Random random(seed);
  Words keys(count);
  for (std::uint32_t& key : keys) key = random.below(values) * (0xffffffffu / values);
  std::sort(keys.begin(), keys.end());
  return keys;
}

void expect_sound(const Cut& result, const std::vector<Ray>& rays, std::uint32_t most_rays) {
  std::uint32_t next = 0;
  for (const Packet& packet : result.packets) {
    ASSERT_EQ(packet.first, next);
    ASSERT_GE(packet.count, 1u);
    ASSERT_LE(packet.count, most_rays);
    next += packet.count;
    const std::uint32_t sense = dominant_sense(rays[result.order[packet.first]].direction);
    for (std::uint32_t i = packet.first; i < next; ++i)
      ASSERT_EQ(dominant_sense(rays[result.order[i]].direction), sense);
  }
  ASSERT_EQ(next, rays.size());
  Words sorted = result.order;
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
}

TEST(Packets, HoldEveryRayOnceWithEqualSigns) {
  for (const std::uint32_t count : {0u, 1u, 255u, 256u, 257u, 5000u}) {
    const std::vector<Ray> rays = random_rays(count, count, false);
    for (const std::uint32_t most : {1u, 7u, 256u}) {
      expect_sound(cut(rays, {}, most), rays, most);
      for (const std::uint32_t values : {1u, 5u, 300u, 1u << 20})
        expect_sound(cut(rays, random_keys(count, values, 3), most), rays, most);
    }
  }
}

TEST(Packets, AreTheLargestCellsOfTheKeysThatFit) {
  const std::uint32_t count = 4000, most = 256;
  const std::vector<Ray> rays = random_rays(count, 1, true);
  for (const std::uint32_t values : {40u, 1000u, 1u << 24}) {
    const Words keys = random_keys(count, values, values);
    for (const Packet& packet : cut(rays, keys, most).packets) {
      const std::uint32_t first = keys[packet.first], last = keys[packet.first + packet.count - 1];
      // The smallest cell around the packet, and its parent.
      std::uint32_t bits = 0;
      while (bits < 32 && (first >> bits) != (last >> bits)) ++bits;
      const auto in_cell = [&](std::uint32_t b) {
        return std::count_if(keys.begin(), keys.end(), [&](std::uint32_t key) {
          return b >= 32 || (key >> b) == (first >> b);
        });
      };
      EXPECT_EQ(in_cell(bits), packet.count);
      while (bits < 32 && in_cell(bits) == packet.count) ++bits;
      EXPECT_GT(in_cell(bits), most);
    }
  }
}

TEST(Packets, OfOneKeyAreCutEvenly) {
  const std::vector<Ray> rays = random_rays(513, 1, true);
  const Cut result = cut(rays, Words(513, 77), 256);
  ASSERT_EQ(result.packets.size(), 3u);
  for (const Packet& packet : result.packets) EXPECT_EQ(packet.count, 171u);
}

TEST(Packets, OppositeRaysAreSeparatedAndKeepTheirOrder) {
  std::vector<Ray> rays(100);
  for (std::size_t i = 0; i < rays.size(); ++i)
    rays[i].direction = {0, 0, i % 2 == 0 ? 1.0f : -1.0f};
  const Cut result = cut(rays, {}, 256);
  ASSERT_EQ(result.packets.size(), 2u);
  for (std::uint32_t i = 0; i < 50; ++i) {
    EXPECT_EQ(result.order[i], 2 * i);
    EXPECT_EQ(result.order[50 + i], 2 * i + 1);
  }
}

TEST(Packets, DependOnlyOnTheBitsOfTheKey) {
  const std::vector<Ray> rays = random_rays(600, 1, true);
  Words keys = random_keys(600, 16, 2);
  for (std::uint32_t& key : keys) key >>= 28;
  const Cut plain = cut(rays, keys, 64, 2, 4);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] |= static_cast<std::uint32_t>(i % 7) << 16;
  const Cut noisy = cut(rays, keys, 64, 2, 4);
  ASSERT_EQ(plain.packets.size(), noisy.packets.size());
  for (std::size_t i = 0; i < plain.packets.size(); ++i)
    EXPECT_EQ(plain.packets[i].first, noisy.packets[i].first);
}

TEST(Packets, DoNotDependOnTheNumberOfThreads) {
  const std::vector<Ray> rays = random_rays(20000, 5, false);
  const Words keys = random_keys(20000, 1 << 16, 6);
  const Cut one = cut(rays, keys, 256, 1);
  for (const std::uint32_t threads : {2u, 5u}) {
    const Cut many = cut(rays, keys, 256, threads);
    EXPECT_EQ(one.order, many.order);
    ASSERT_EQ(one.packets.size(), many.packets.size());
    for (std::size_t i = 0; i < one.packets.size(); ++i)
      EXPECT_EQ(one.packets[i].first, many.packets[i].first);
  }
}

}  // namespace
}  // namespace raysheaf
