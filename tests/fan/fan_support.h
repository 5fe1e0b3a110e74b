// Triangles in runs, and brute force's answers for them.
#pragma once

#include <vector>

#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"
#include "methods/fan/fan.h"
#include "support/random.h"

namespace raysheaf::test {

struct Triangles {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> indices;
  std::vector<TriangleRun> runs;
  std::vector<std::uint8_t> flags;

  void add(Vec3 a, Vec3 b, Vec3 c) { positions.insert(positions.end(), {a, b, c}); }
  [[nodiscard]] std::uint32_t count() const {
    return static_cast<std::uint32_t>(positions.size() / 3);
  }
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t i) const {
    return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
  }

  /// Cuts the triangles into runs of up to `longest`; every other run is indexed.
  TriangleSource source(std::uint32_t longest = 37) {
    indices.clear();
    runs.clear();
    for (std::uint32_t i = 0; i < count(); ++i) indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (std::uint32_t first = 0; first < count(); first += longest) {
      const std::uint32_t n = std::min(longest, count() - first);
      if (runs.size() % 2 == 0)
        runs.push_back({positions.data(), indices.data() + first, first, n});
      else
        runs.push_back({positions.data() + 3 * std::size_t{first}, nullptr, first, n});
    }
    return {View<const TriangleRun>(runs), count(), flags.empty() ? nullptr : flags.data()};
  }
};

inline std::vector<std::uint8_t> brute_force(const Triangles& triangles,
                                             const std::vector<Ray>& rays, Facing facing) {
  std::vector<std::uint8_t> occluded(rays.size(), 0);
  for (std::uint32_t i = 0; i < triangles.count(); ++i) {
    const auto [a, b, c] = triangles.corners(i);
    for (std::size_t r = 0; r < rays.size(); ++r) {
      TriangleHit hit;
      if (occluded[r] == 0 && intersect_triangle(make_ray_setup(rays[r]), a, b, c, &hit) &&
          (triangles.flags.empty() || shows(facing, triangles.flags[i], hit.front)))
        occluded[r] = 1;
    }
  }
  return occluded;
}

inline std::vector<std::uint8_t> fan(const Executor& executor, const TriangleSource& source,
                                     const std::vector<Ray>& rays, FanOptions options = {},
                                     FanCounts* counts = nullptr,
                                     std::vector<float>* ray_tests = nullptr) {
  std::vector<std::uint8_t> occluded(rays.size(), 7);
  View<float> tests;
  if (ray_tests != nullptr) {
    ray_tests->assign(rays.size(), 0);
    tests = *ray_tests;
  }
  options.count = true;
  EXPECT_TRUE(occluded_in_fan(executor, source, rays, options, occluded, tests, counts));
  return occluded;
}

}  // namespace raysheaf::test
