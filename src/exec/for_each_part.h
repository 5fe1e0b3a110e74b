// A parallel loop over items of different sizes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "exec/executor.h"

namespace raysheaf {

/// Calls `body(i, begin, end)` for parts that together are [0, sizes[i]) of each i, in parallel:
/// large items are cut, and small ones share a task.
template <class Body>
void for_each_part(const Executor& executor, const std::vector<std::size_t>& sizes,
                   const Body& body) {
  std::vector<std::size_t> ends(sizes.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) ends[i] = count += sizes[i];
  executor.for_each_block(count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    auto i =
        static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), begin) - ends.begin());
    for (; begin < end; ++i) {
      const std::size_t first = ends[i] - sizes[i], stop = std::min(end, ends[i]);
      if (begin < stop) body(i, begin - first, stop - first);
      begin = stop;
    }
  });
}

}  // namespace raysheaf
