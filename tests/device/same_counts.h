// The counts of a batch on a device and on the CPU.
#pragma once

#include <gtest/gtest.h>

#include "raysheaf/statistics.h"

namespace raysheaf::test {

inline void expect_same_counts(const BatchStatistics& a, const BatchStatistics& b) {
  EXPECT_EQ(a.chunks, b.chunks);
  EXPECT_EQ(a.mesh_sphere_tests, b.mesh_sphere_tests);
  EXPECT_EQ(a.final_tests, b.final_tests);
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t l = 0; l < a.levels.size(); ++l) {
    EXPECT_EQ(a.levels[l].level, b.levels[l].level);
    EXPECT_EQ(a.levels[l].tests, b.levels[l].tests) << "level " << a.levels[l].level;
    EXPECT_EQ(a.levels[l].hits, b.levels[l].hits) << "level " << a.levels[l].level;
  }
}

}  // namespace raysheaf::test
