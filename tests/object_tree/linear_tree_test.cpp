#include "object_tree/linear_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "emulated/emulated_device.h"
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

/// Triangles scaled from the origin, triangle i by `size(i)`. Before scaling, its box has sides of
/// 2 from `corner` on.
std::vector<Vec3> of_sizes(std::uint32_t count, Vec3 corner,
                           const std::function<float(std::uint32_t)>& size) {
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i < count; ++i)
    for (const Vec3 c : {Vec3{0, 0, 0}, Vec3{2, 2, 0}, Vec3{0, 2, 2}})
      corners.push_back((corner + c) * size(i));
  return corners;
}

bool holds(const Box& outer, const Box& inner) {
  return box_union(outer, inner).min == outer.min && box_union(outer, inner).max == outer.max;
}

/// Visits the nodes below `at`; returns their height.
std::uint32_t visit(const LinearTreeView& tree, std::uint32_t at, Box* bounds,
                    std::vector<int>* seen) {
  std::uint32_t height = 0;
  for (int side = 0; side < 2; ++side) {
    const LinearNode& node = tree.nodes[at];
    Box below;
    const std::uint32_t child = node.child[side];
    if ((child & kLeafBit) != 0) {
      std::uint32_t place = child & ~kLeafBit, size = 0;
      for (bool more = true; more; ++place, ++size) {
        const LinearTriangle& t = tree.triangles[place];
        below = box_union(below, triangle_box(t.a, t.b, t.c));
        ++(*seen)[t.id];
        more = t.ends_leaf == 0;
      }
      EXPECT_LE(size, kLinearLeaf);
    } else {
      height = std::max(height, visit(tree, child, &below, seen));
    }
    EXPECT_TRUE(holds(node.box[side], below) && holds(below, node.box[side]));
    *bounds = box_union(*bounds, below);
  }
  EXPECT_EQ(tree.nodes[at].height, height + 1);
  return height + 1;
}

/// Checks every node and leaf of a tree over `corners`; returns its height.
std::uint32_t checked_height(const std::vector<Vec3>& corners) {
  const Executor executor(2);
  HostAllocator memory;
  EmulatedDevice device(executor, memory);
  LinearTree tree(device.allocator());
  tree.build(device, {corners, {}});
  std::vector<int> seen(corners.size() / 3);
  Box bounds;
  const std::uint32_t height = visit(tree.view(), 0, &bounds, &seen);
  EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
  EXPECT_LE(height, kLinearDepth);
  return height;
}

TEST(LinearTreeOf, TrianglesAreInOneLeafEachUnderBoxesThatFit) {
  for (const std::uint32_t count : {5u, 6u, 7u, 9u, 12u, 33u, 100u, 5000u})
    for (std::uint64_t seed = 0; seed < 4; ++seed)
      EXPECT_LE(checked_height(scattered(count, seed + count)), count - kLinearLeaf);
}

TEST(LinearTreeOf, NoPathIsLongerThanTheTraversalStack) {
  for (const std::uint32_t count : {5u, 100u, 70000u}) {
    checked_height(of_sizes(count, {1, 1, 1}, [](std::uint32_t) { return 1.0f; }));
    checked_height(of_sizes(count, {1, 1, 1}, [](std::uint32_t) { return 0.0f; }));
    checked_height(
        of_sizes(count, {1, 1, 1}, [](std::uint32_t i) { return static_cast<float>(i); }));
  }
  // Nested boxes with a common centre: the smallest one is always joined with the next, which would
  // make one long path. Keys differ only in the triangles' numbers.
  const auto grows = [](std::uint32_t i) { return std::pow(1.0002f, static_cast<float>(i)); };
  EXPECT_LE(checked_height(of_sizes(70000, {-1, -1, -1}, grows)), bits_for(70000));
}

/// The SAH cost of the tree over runs, divided by the number of triangles of a tree that is built.
double cost_of_runs(const LinearTreeView& tree, const Box& scene) {
  const LinearKeys made_up(tree.count);
  std::vector<std::uint64_t> keys;
  for (std::uint32_t i = 0; i < tree.count; ++i) {
    const LinearTriangle& t = tree.triangles[i];
    keys.push_back(linear_key(made_up, scene, triangle_box(t.a, t.b, t.c), t.id));
  }
  std::uint64_t sum = 0;
  const std::function<Box(std::uint32_t, std::uint32_t)> box_of_run = [&](std::uint32_t first,
                                                                          std::uint32_t last) {
    Box box;
    if (last - first < kLinearLeaf) {
      for (std::uint32_t i = first; i <= last; ++i)
        box = box_union(
            box, triangle_box(tree.triangles[i].a, tree.triangles[i].b, tree.triangles[i].c));
    } else {
      const int whole = shared_prefix(keys.data(), tree.count, first, last);
      std::uint32_t cut = first;
      while (shared_prefix(keys.data(), tree.count, first, cut + 1) > whole) ++cut;
      box = box_union(box_of_run(first, cut), box_of_run(cut + 1, last));
    }
    sum += first == 0 && last + 1 == tree.count ? 0 : surface_parts(box, scene);
    return box;
  };
  box_of_run(0, tree.count - 1);
  return static_cast<double>(sum) / static_cast<double>(surface_parts(scene, scene));
}

TEST(LinearTreeOf, JoiningTheClosestMakesItCheaperThanItsRuns) {
  const Executor executor(2);
  HostAllocator memory;
  EmulatedDevice device(executor, memory);
  for (const std::uint32_t count : {300u, 5000u, 50000u}) {
    const std::vector<Vec3> corners = scattered(count, 1);
    LinearTree tree(device.allocator());
    tree.build(device, {corners, {}});
    const double cost = tree.cost(device);
    EXPECT_LT(cost, (count < 1000 ? 1 : 0.9) * cost_of_runs(tree.view(), box_of(*tree.scene())));
    tree.refit(device, {corners, {}});
    EXPECT_EQ(tree.cost(device), cost) << "a refit finds the same boxes";
  }
}

/// Lists all nodes below the root in depth-first order.
void list_nodes(const LinearTreeView& tree, std::uint32_t at, std::vector<LinearNode>* out) {
  if ((at & kLeafBit) != 0) return;
  out->push_back(tree.nodes[at]);
  for (const std::uint32_t child : tree.nodes[at].child) list_nodes(tree, child, out);
}

TEST(LinearTreeOf, ThreadsChangeNothing) {
  const std::vector<Vec3> corners = scattered(20000, 3);
  std::vector<LinearNode> first;
  double cost = 0;
  for (const std::uint32_t threads : {1u, 2u, 3u, 7u, 7u}) {
    const Executor executor(threads);
    HostAllocator memory;
    EmulatedDevice device(executor, memory);
    LinearTree tree(device.allocator());
    tree.build(device, {corners, {}});
    std::vector<LinearNode> nodes;
    list_nodes(tree.view(), 0, &nodes);
    if (first.empty()) {
      first = nodes;
      cost = tree.cost(device);
    }
    ASSERT_EQ(nodes.size(), first.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      EXPECT_EQ(std::memcmp(nodes[i].box, first[i].box, sizeof nodes[i].box), 0);
      EXPECT_TRUE(nodes[i].child[0] == first[i].child[0] && nodes[i].child[1] == first[i].child[1]);
    }
    EXPECT_EQ(tree.cost(device), cost);
  }
}

TEST(LinearTreeOf, BoxesFollowTrianglesThatMove) {
  const Executor executor(2);
  HostAllocator memory;
  EmulatedDevice device(executor, memory);
  std::vector<Vec3> corners = scattered(3000, 5);
  LinearTree tree(device.allocator());
  tree.build(device, {corners, {}});
  Random random(6);
  for (Vec3& c : corners) c = c + random.in_box(3);
  tree.refit(device, {corners, {}});
  std::vector<int> seen(3000);
  Box bounds;
  visit(tree.view(), 0, &bounds, &seen);
  EXPECT_EQ(seen, std::vector<int>(3000, 1));
  const Box scene = box_of(*tree.scene());
  EXPECT_TRUE(holds(scene, bounds) && holds(bounds, scene));
}

}  // namespace
}  // namespace raysheaf::test
