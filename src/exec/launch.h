// Distributes a loop over a grid of threads: enough blocks to fill the machine, and no more. Each
// thread takes the items at a stride of the number of threads.
//
//   items    0  1  2  3  4  5  6  7  8  9 10 11 12
//   threads  0  1  2  3  4  5 | 0  1  2  3  4  5 | 0      two blocks of three: a stride of six
//
// Neighbouring threads have neighbouring items, so that they read contiguous memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"

namespace raysheaf {

inline constexpr std::uint32_t kBlockThreads = 128;

struct LaunchShape {
  std::uint32_t blocks = 0;  ///< 0 for an empty loop, which is not launched
  std::uint32_t threads = kBlockThreads;

  [[nodiscard]] RAYSHEAF_HD std::size_t stride() const { return std::size_t{blocks} * threads; }
};

/// `most_blocks`: the number that fills the machine, at least 1.
[[nodiscard]] constexpr LaunchShape launch_shape(std::size_t count, std::uint32_t most_blocks) {
  const std::size_t blocks = count / kBlockThreads + (count % kBlockThreads != 0 ? 1 : 0);
  return {blocks < most_blocks ? static_cast<std::uint32_t>(blocks) : most_blocks, kBlockThreads};
}

/// Calls `body(i)` for the items of one thread; threads are numbered over all blocks.
template <class Body>
RAYSHEAF_HD void for_items_of_thread(std::size_t thread, std::size_t stride, std::size_t count,
                                     const Body& body) {
  for (std::size_t i = thread; i < count;) {
    body(i);
    if (count - i <= stride) return;  // i + stride might overflow
    i += stride;
  }
}

}  // namespace raysheaf
