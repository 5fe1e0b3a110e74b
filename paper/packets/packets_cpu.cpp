#include "exec/scan.h"
#include "paper/packets/cut_body.h"

namespace raysheaf {
namespace {

constexpr std::size_t kSplitGrain = 8;

void cut_evenly(Packet run, std::uint32_t most_rays, std::vector<Packet>* packets) {
  const std::uint64_t parts = even_parts(run, most_rays);
  for (std::uint64_t i = 0; i < parts; ++i) packets->push_back(even_part(run, i, parts));
}

/// `bits`: the number of low bits in which the keys of the cell may differ.
void cut_by_key(View<const std::uint32_t> keys, Packet cell, std::uint32_t bits,
                std::uint32_t most_rays, std::vector<Packet>* packets) {
  if (cell.count == 0) return;
  if (cell.count <= most_rays) return packets->push_back(cell);
  if (bits == 0) return cut_evenly(cell, most_rays, packets);
  const std::uint32_t low = lower_half(keys, cell, 1u << (bits - 1));
  cut_by_key(keys, {cell.first, low}, bits - 1, most_rays, packets);
  cut_by_key(keys, {cell.first + low, cell.count - low}, bits - 1, most_rays, packets);
}

std::vector<Packet> part_by_sense(const Executor& executor, View<const Ray> rays,
                                  const std::vector<Packet>& whole, View<std::uint32_t> order) {
  std::vector<SenseCounts> counts(whole.size());
  std::vector<std::uint32_t> places(whole.size());
  executor.for_each(whole.size(), kSplitGrain, [&](std::size_t p) {
    const auto members = order.slice(whole[p].first, whole[p].count);
    counts[p] = count_senses(rays, {members.data, members.size});
    places[p] = counts[p].packets();
    if (places[p] < 2) return;
    const std::vector<std::uint32_t> old(members.begin(), members.end());
    part_members(rays, counts[p], View<const std::uint32_t>(old), members.data);
  });
  std::vector<Packet> packets(exclusive_scan(executor, places, places));
  executor.for_each(whole.size(), kSplitGrain, [&](std::size_t p) {
    write_packets(counts[p], whole[p].first, packets.data() + places[p]);
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
