#include "scene/placed_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <tuple>
#include <vector>

#include "exec/executor.h"
#include "scene/placed_bounds.h"
#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::below;
using test::Random;

/// Meshes, with and without indices, and instances of them by id.
struct PlacedWorld {
  explicit PlacedWorld(Random& random) {
    for (int m = 0; m < 5; ++m)
      meshes.push_back(
          test::random_mesh(random, 3 * (1 + below(random, 3000)), 1 + below(random, 5000), 2));
  }

  PlacedInstance instance(std::uint32_t mesh, std::uint32_t id, const Affine& to_world) const {
    const Mesh& m = meshes[mesh];
    const bool soup = mesh % 2 == 1;
    const std::size_t triangles = soup ? m.positions.size() / 3 : m.triangles.size();
    return {View<const Vec3>(m.positions),
            soup ? nullptr : m.triangles.data(),
            static_cast<std::uint32_t>(triangles),
            mesh,
            id,
            to_world};
  }

  std::vector<Mesh> meshes;
};

/// Some of these maps have rows in common.
Affine placed_map(Random& random) {
  Affine map;
  if (below(random, 3) == 0) return map;
  if (below(random, 2) == 0) return test::random_map(random);
  for (auto& row : map.m) row[3] = static_cast<float>(below(random, 3));
  return map;
}

bool equal_bits(Vec3 a, Vec3 b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Every corner of every run, and the boxes, by their definition.
void expect_placed(const Executor& executor, const PlacedRuns& placed) {
  const View<const TriangleRun> runs = placed.runs();
  ASSERT_EQ(runs.size, placed.instances().size);
  const std::vector<Box> boxes = boxes_of(executor, runs);
  std::uint32_t first = 0;
  Box all;
  for (std::size_t r = 0; r < runs.size; ++r) {
    const PlacedInstance& instance = placed.instances()[r];
    ASSERT_EQ(runs[r].first, first);
    ASSERT_EQ(runs[r].count, instance.triangle_count);
    Box box;
    const InstanceCorners placed_corners(instance);
    for (std::uint32_t i = 0; i < runs[r].count; ++i) {
      const std::array<Vec3, 3> corners = runs[r].corners(i), same = placed_corners(i);
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex =
            instance.triangles == nullptr ? 3 * i + k : instance.triangles[i][k];
        const Vec3 from = instance.positions[vertex];
        ASSERT_TRUE(equal_bits(
            corners[k], instance.is_identity() ? from : transform_point(instance.to_world, from)));
        ASSERT_TRUE(equal_bits(corners[k], same[k]));
        box.min = min(box.min, corners[k]);
        box.max = max(box.max, corners[k]);
      }
    }
    EXPECT_EQ(boxes[r].min, box.min);
    EXPECT_EQ(boxes[r].max, box.max);
    all.min = min(all.min, box.min);
    all.max = max(all.max, box.max);
    first += runs[r].count;
  }
  EXPECT_EQ(placed.triangle_count(), first);
  const Box bounds = placed_bounds(executor, placed.instances());
  EXPECT_EQ(bounds.min, all.min);
  EXPECT_EQ(bounds.max, all.max);
}

TEST(PlacedRuns, ListsAndMovesGiveEveryCornerItsPlace) {
  Random random(11);
  for (const std::uint32_t threads : {1u, 4u}) {
    const Executor executor(threads);
    const PlacedWorld world(random);
    PlacedRuns placed;
    expect_placed(executor, placed);
    std::vector<PlacedInstance> all;
    for (int round = 0; round < 60; ++round) {
      std::vector<std::uint32_t> moved;
      if (below(random, 3) == 0) {  // some go, and others come
        std::erase_if(all, [&](const PlacedInstance& /*one*/) { return below(random, 4) == 0; });
        std::vector<std::uint32_t> fresh;
        for (std::uint32_t i = below(random, 4); i > 0; --i) {
          fresh.push_back(static_cast<std::uint32_t>(1000 * round) + i);
          all.push_back(world.instance(below(random, 5), fresh.back(), placed_map(random)));
        }
        std::sort(all.begin(), all.end(), [](const PlacedInstance& a, const PlacedInstance& b) {
          return std::tie(a.geom_id, a.inst_id) < std::tie(b.geom_id, b.inst_id);
        });
        placed.list(all);
        for (std::uint32_t i = 0; i < all.size(); ++i)
          if (std::count(fresh.begin(), fresh.end(), all[i].inst_id) != 0) moved.push_back(i);
      }
      for (std::uint32_t i = 0; i < all.size(); ++i) {
        if (below(random, 3) != 0 || std::count(moved.begin(), moved.end(), i) != 0) continue;
        all[i].to_world = placed_map(random);
        placed.set(i, all[i]);
        moved.push_back(i);
      }
      ASSERT_EQ(placed.place(executor, View<const std::uint32_t>(moved)), kInvalidId);
      expect_placed(executor, placed);
      if (HasFailure()) return;
    }
  }
}

TEST(PlacedRuns, NamesTheLeastInstanceThatLeavesTheWorld) {
  const std::vector<Vec3> positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {3e18f, 0, 0}};
  const std::array<std::uint32_t, 3> triangle = {0, 1, 2};
  Affine far;
  for (int axis = 0; axis < 3; ++axis) far.m[static_cast<std::size_t>(axis)][3] = 9e17f;
  Affine farther = far;
  farther.m[1][3] = 1.1e18f;
  const Executor executor(2);
  PlacedRuns placed;
  const auto place = [&](std::uint32_t id, const Affine& map) {
    return PlacedInstance{View<const Vec3>(positions), &triangle, 1, 0, id, map};
  };
  placed.list({place(3, far), place(5, farther), place(8, farther)});
  const std::vector<std::uint32_t> all = {2, 1, 0}, one = {0};
  EXPECT_EQ(placed.place(executor, View<const std::uint32_t>(all)), 5u);
  // A vertex that no triangle uses may be anywhere.
  EXPECT_EQ(placed.place(executor, View<const std::uint32_t>(one)), kInvalidId);
}

}  // namespace
}  // namespace raysheaf
