#include "paper/base/level_counts.h"

#include <algorithm>

namespace raysheaf {

void LevelCounts::add_to(BatchStatistics* statistics) const {
  const auto levels = static_cast<std::uint32_t>(tests.size());
  statistics->levels.resize(std::max<std::size_t>(levels, statistics->levels.size()));
  for (std::uint32_t l = 1; l <= levels; ++l) {
    LevelStatistics& level = statistics->levels[levels - l];
    level.level = l;
    level.tests += tests[l - 1];
    level.hits += hits[l - 1];
  }
  statistics->final_tests += final_tests;
  statistics->mesh_sphere_tests += mesh_sphere_tests;
}

}  // namespace raysheaf
