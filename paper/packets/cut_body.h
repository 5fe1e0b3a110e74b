// The work for one ray or one packet when ordered rays are cut (paper/packets/packets.h); the
// loops are in packets_cpu.cpp and paper/packets/packet_cuts_device.h.
#pragma once

#include "base/bits.h"
#include "base/search.h"
#include "paper/packets/packets.h"

namespace raysheaf {

/// Part `part` of `parts` nearly equal parts of a run.
RAYSHEAF_HD inline Packet even_part(Packet run, std::uint64_t part, std::uint64_t parts) {
  const auto begin = static_cast<std::uint32_t>(part * run.count / parts);
  const auto end = static_cast<std::uint32_t>((part + 1) * run.count / parts);
  return {run.first + begin, end - begin};
}

/// The fewest parts with at most `most_rays` each.
RAYSHEAF_HD inline std::uint64_t even_parts(Packet run, std::uint32_t most_rays) {
  return div_ceil(run.count, most_rays);
}

/// The number of a cell's rays in the lower half of the curve through it, whose keys lack `bit`,
/// the highest bit in which they differ.
RAYSHEAF_HD inline std::uint32_t lower_half(View<const std::uint32_t> sorted_keys, Packet cell,
                                            std::uint32_t bit) {
  const std::uint32_t* const keys = sorted_keys.data + cell.first;
  return static_cast<std::uint32_t>(first_not_below(
      [&](std::size_t k) { return std::uint64_t{keys[k] & bit}; }, cell.count, bit));
}

/// The rays around place `place` of `count` before they are split by sense: the largest cell of the
/// curve that has at most `most_rays`, or a part of the smallest cell; without keys, a part of all
/// rays.
RAYSHEAF_HD inline Packet packet_about(View<const std::uint32_t> sorted_keys,
                                       std::uint32_t key_bits, std::uint32_t most_rays,
                                       std::uint32_t count, std::uint32_t place) {
  Packet cell{0, count};
  if (!sorted_keys.empty()) {
    for (std::uint32_t bits = key_bits; bits > 0 && cell.count > most_rays; --bits) {
      const std::uint32_t low = lower_half(sorted_keys, cell, 1u << (bits - 1));
      const bool upper = place >= cell.first + low;
      cell = upper ? Packet{cell.first + low, cell.count - low} : Packet{cell.first, low};
    }
  }
  const std::uint64_t parts = even_parts(cell, most_rays);
  // The last part that begins at or before the place.
  const std::uint64_t part = (std::uint64_t{place - cell.first + 1} * parts - 1) / cell.count;
  return even_part(cell, part, parts);
}

inline constexpr std::uint32_t kSenses = 6;

struct SenseCounts {
  std::uint32_t count[kSenses] = {};

  /// Number of packets that they make.
  [[nodiscard]] RAYSHEAF_HD std::uint32_t packets() const {
    std::uint32_t some = 0;
    for (const std::uint32_t n : count) some += n != 0 ? 1 : 0;
    return some;
  }
};

/// `members`: numbers of rays.
RAYSHEAF_HD inline SenseCounts count_senses(View<const Ray> rays,
                                            View<const std::uint32_t> members) {
  SenseCounts counts;
  for (const std::uint32_t ray : members) ++counts.count[dominant_sense(rays.data[ray].direction)];
  return counts;
}

/// Groups the members by sense, in stable order. `out` must not overlap.
RAYSHEAF_HD inline void part_members(View<const Ray> rays, const SenseCounts& counts,
                                     View<const std::uint32_t> members, std::uint32_t* out) {
  std::uint32_t place[kSenses], first = 0;
  for (std::uint32_t s = 0; s < kSenses; ++s) {
    place[s] = first;
    first += counts.count[s];
  }
  for (const std::uint32_t ray : members)
    out[place[dominant_sense(rays.data[ray].direction)]++] = ray;
}

/// The packets of the senses that occur, consecutively from `first` on.
RAYSHEAF_HD inline void write_packets(const SenseCounts& counts, std::uint32_t first, Packet* out) {
  for (const std::uint32_t count : counts.count) {
    if (count != 0) *out++ = {first, count};
    first += count;
  }
}

}  // namespace raysheaf
