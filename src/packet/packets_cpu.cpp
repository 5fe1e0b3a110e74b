#include <algorithm>
#include <array>
#include <numeric>

#include "base/bits.h"
#include "exec/scan.h"
#include "packet/packets.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kSenses = 6;
constexpr std::size_t kSplitGrain = 8;

/// Into as few parts as can be, of nearly equal size.
void cut_evenly(Packet run, std::uint32_t most_rays, std::vector<Packet>* packets) {
  const std::uint64_t parts = div_ceil(run.count, most_rays);
  for (std::uint64_t i = 0; i < parts; ++i) {
    const auto begin = static_cast<std::uint32_t>(i * run.count / parts);
    const auto end = static_cast<std::uint32_t>((i + 1) * run.count / parts);
    packets->push_back({run.first + begin, end - begin});
  }
}

/// `bits`: in how many low bits the keys of the cell may differ.
void cut_by_key(View<const std::uint32_t> keys, Packet cell, std::uint32_t bits,
                std::uint32_t most_rays, std::vector<Packet>* packets) {
  if (cell.count == 0) return;
  if (cell.count <= most_rays) return packets->push_back(cell);
  if (bits == 0) return cut_evenly(cell, most_rays, packets);
  const std::uint32_t bit = 1u << (bits - 1);
  const std::uint32_t* begin = keys.begin() + cell.first;
  const std::uint32_t* middle = std::partition_point(
      begin, begin + cell.count, [&](std::uint32_t key) { return (key & bit) == 0; });
  const auto left = static_cast<std::uint32_t>(middle - begin);
  cut_by_key(keys, {cell.first, left}, bits - 1, most_rays, packets);
  cut_by_key(keys, {cell.first + left, cell.count - left}, bits - 1, most_rays, packets);
}

using SenseCounts = std::array<std::uint32_t, kSenses>;

SenseCounts count_senses(View<const Ray> rays, View<const std::uint32_t> members) {
  SenseCounts counts{};
  for (const std::uint32_t ray : members) ++counts[dominant_sense(rays[ray].direction)];
  return counts;
}

/// Brings the rays of each sense together; stable.
void part(View<const Ray> rays, const SenseCounts& counts, View<std::uint32_t> members) {
  const std::vector<std::uint32_t> old(members.begin(), members.end());
  SenseCounts place{};
  std::exclusive_scan(counts.begin(), counts.end(), place.begin(), 0u);
  for (const std::uint32_t ray : old) members[place[dominant_sense(rays[ray].direction)]++] = ray;
}

std::vector<Packet> part_by_sense(const Executor& executor, View<const Ray> rays,
                                  const std::vector<Packet>& whole, View<std::uint32_t> order) {
  std::vector<SenseCounts> counts(whole.size());
  std::vector<std::uint32_t> places(whole.size());
  executor.for_each(whole.size(), kSplitGrain, [&](std::size_t p) {
    const auto members = order.slice(whole[p].first, whole[p].count);
    counts[p] = count_senses(rays, {members.data, members.size});
    places[p] = static_cast<std::uint32_t>(
        std::count_if(counts[p].begin(), counts[p].end(), [](auto n) { return n != 0; }));
    if (places[p] > 1) part(rays, counts[p], members);
  });
  std::vector<Packet> packets(exclusive_scan(executor, places, places));
  executor.for_each(whole.size(), kSplitGrain, [&](std::size_t p) {
    std::uint32_t first = whole[p].first, place = places[p];
    for (const std::uint32_t count : counts[p]) {
      if (count != 0) packets[place++] = {first, count};
      first += count;
    }
  });
  return packets;
}

}  // namespace

std::vector<Packet> make_packets(const Executor& executor, View<const Ray> rays,
                                 View<const std::uint32_t> sorted_keys, std::uint32_t key_bits,
                                 std::uint32_t most_rays, View<std::uint32_t> order) {
  std::vector<Packet> packets;
  const Packet all{0, static_cast<std::uint32_t>(order.size)};
  if (sorted_keys.empty()) {
    cut_evenly(all, most_rays, &packets);
  } else {
    cut_by_key(sorted_keys, all, key_bits, most_rays, &packets);
  }
  return part_by_sense(executor, rays, packets, order);
}

}  // namespace raysheaf
