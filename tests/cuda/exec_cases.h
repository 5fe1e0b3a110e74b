// The building blocks of a device's operations.
#pragma once

#include "cuda/words.h"
#include "exec/launch.h"

namespace raysheaf::test {

struct LaunchCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const LaunchShape shape{1 + draws.below(5), kBlockThreads};
    const std::size_t thread = draws.below(static_cast<std::uint32_t>(shape.stride()));
    std::uint64_t sum = 0;
    std::uint32_t calls = 0;
    for_items_of_thread(thread, shape.stride(), draws.below(3000), [&](std::size_t i) {
      sum += i;
      ++calls;
    });
    out.put(sum, calls);
  }
};

}  // namespace raysheaf::test
