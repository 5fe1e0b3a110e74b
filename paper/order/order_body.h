// The work for one item in each step of the order; the loops are in order_cpu.cpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"

namespace raysheaf {

/// A ray begins a chunk if its key differs from its predecessor's; the first ray always does.
RAYSHEAF_HD inline bool begins_chunk(const std::uint32_t* keys, std::size_t ray) {
  return ray == 0 || keys[ray] != keys[ray - 1];
}

/// The chunk that a head begins: the inclusive scan of the head flags counts the head itself.
RAYSHEAF_HD inline std::uint32_t chunk_of_head(std::uint32_t heads_up_to_ray) {
  return heads_up_to_ray - 1;
}

/// The chunk of place `place`: the last that starts at or before it. `starts` is the exclusive scan
/// of the sizes, hence starts[0] = 0; count >= 1.
template <class Count>
RAYSHEAF_HD std::uint32_t chunk_at(const Count* starts, std::uint32_t count, Count place) {
  std::uint32_t first = 0;
  while (count > 1) {
    const std::uint32_t half = count / 2;
    if (starts[first + half] <= place) first += half;
    count -= half;
  }
  return first;
}

}  // namespace raysheaf
