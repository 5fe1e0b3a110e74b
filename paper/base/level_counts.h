// The counts of a hierarchy's levels.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/statistics.h"

namespace raysheaf {

struct LevelCounts {
  std::vector<std::uint64_t> tests, hits;  ///< [0] is level 1
  std::uint64_t final_tests = 0;           ///< rays with triangles
  std::uint64_t mesh_sphere_tests = 0;

  void add_to(BatchStatistics* statistics) const;
};

}  // namespace raysheaf
