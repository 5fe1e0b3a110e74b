#include "object/linear_tree.h"

#include <gtest/gtest.h>

#include "exec/cpu/emulated_device.h"
#include "tests/support/random.h"

namespace raysheaf::test {
namespace {

std::vector<Vec3> scattered(std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  const auto point = [&](float size) { return random.in_box(size); };
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 a = point(random.below(3) == 0 ? 1.0f : 50.0f);
    for (const Vec3 c : {a, a + point(2), a + point(i % 7 == 0 ? 30.0f : 1.0f)})
      corners.push_back(c);
  }
  return corners;
}

bool holds(const Box& outer, const Box& inner) {
  return box_union(outer, inner).min == outer.min && box_union(outer, inner).max == outer.max;
}

/// Goes through the nodes below `at`; returns their height.
std::uint32_t visit(const LinearTreeView& tree, std::uint32_t at, Box* bounds,
                    std::vector<int>* seen) {
  std::uint32_t height = 0;
  for (int side = 0; side < 2; ++side) {
    const LinearNode& node = tree.nodes[at];
    Box below;
    const std::uint32_t child = node.child[side];
    if ((child & kLeafBit) != 0) {
      std::uint32_t place = child & ~kLeafBit;
      for (bool more = true; more; ++place) {
        const LinearTriangle& t = tree.triangles[place];
        below = box_union(below, triangle_box(t.a, t.b, t.c));
        ++(*seen)[t.id];
        more = t.ends_leaf == 0;
      }
    } else {
      height = std::max(height, visit(tree, child, &below, seen));
    }
    EXPECT_TRUE(holds(node.box[side], below) && holds(below, node.box[side]));
    *bounds = box_union(*bounds, below);
  }
  EXPECT_EQ(tree.nodes[at].height, height + 1);
  return height + 1;
}

TEST(LinearTreeOf, TrianglesAreInOneLeafEachUnderBoxesThatFit) {
  const Executor executor(2);
  HostAllocator memory;
  EmulatedDevice device(executor, memory);
  for (const std::uint32_t count : {5u, 6u, 9u, 100u, 5000u}) {
    const std::vector<Vec3> corners = scattered(count, count);
    LinearTree tree(device.allocator());
    tree.build(device, {corners, {}});
    std::vector<int> seen(count);
    Box bounds;
    EXPECT_LE(visit(tree.view(), 0, &bounds, &seen), kLinearDepth);
    EXPECT_EQ(seen, std::vector<int>(count, 1));
  }
}

TEST(LinearTreeOf, ChildrenThatChangePlacesMakeItCheaper) {
  const Executor executor(2);
  HostAllocator memory;
  EmulatedDevice device(executor, memory);
  const std::vector<Vec3> corners = scattered(5000, 1);
  LinearTree tree(device.allocator());
  tree.build(device, {corners, {}});
  const double first = tree.cost(device);
  tree.fit(device, true);
  const double second = tree.cost(device);
  EXPECT_LT(second, first);
  tree.refit(device, {corners, {}});
  EXPECT_EQ(tree.cost(device), second) << "a refit leaves them where they are";
}

}  // namespace
}  // namespace raysheaf::test
