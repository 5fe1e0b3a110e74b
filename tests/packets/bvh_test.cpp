#include "paper/packets/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "paper/base/flat_arrays.h"
#include "support/soups.h"

namespace raysheaf {
namespace {

FlatArrays arrays_of(const SceneDescription& scene) {
  const Executor executor(2);
  return {executor, flatten(executor, scene, mesh_bounds(executor, scene))};
}

/// Follows the tree from the root: counts how often each triangle and each node is reached, and
/// checks that every box is the union of the boxes below it.
struct Visit {
  const Bvh& bvh;
  const TriangleView& scene;
  std::vector<int> triangle_visits, node_visits;
  std::vector<std::uint32_t> depths;  ///< of the nodes
  std::uint32_t leaves = 0;

  Visit(const Bvh& tree, const TriangleView& triangles)
      : bvh(tree),
        scene(triangles),
        triangle_visits(triangles.count),
        node_visits(tree.nodes.size()),
        depths(tree.nodes.size()) {
    if (!bvh.nodes.empty()) (void)node(0, 0);
  }

  Box node(std::uint32_t number, std::uint32_t depth) {
    ++node_visits[number];
    depths[number] = depth;
    const BvhNode& n = bvh.nodes[number];
    EXPECT_GE(n.children, 1u);
    EXPECT_LE(n.children, kBvhWidth);
    Box all;
    for (std::uint32_t c = 0; c < n.children; ++c) {
      const Box inside = n.is_leaf(c) ? leaf(n, c) : node(n.first[c], depth + 1);
      EXPECT_TRUE(n.box(c).min == inside.min && n.box(c).max == inside.max)
          << "node " << number << " child " << c;
      all.min = min(all.min, inside.min);
      all.max = max(all.max, inside.max);
    }
    return all;
  }

  Box leaf(const BvhNode& n, std::uint32_t c) {
    ++leaves;
    EXPECT_LE(n.count[c], kLeafTriangles);
    Box all;
    for (std::uint32_t i = 0; i < n.count[c]; ++i) {
      const std::uint32_t triangle = bvh.triangles[n.first[c] + i];
      ++triangle_visits[triangle];
      for (int k = 0; k < 3; ++k) {
        all.min = min(all.min, scene.corner(triangle, k));
        all.max = max(all.max, scene.corner(triangle, k));
      }
    }
    return all;
  }
};

void expect_sound(const TriangleView& scene) {
  const Bvh bvh = build_bvh(Executor(2), scene);
  ASSERT_EQ(bvh.triangles.size(), scene.count);
  const Visit visit(bvh, scene);
  for (const int visits : visit.triangle_visits) EXPECT_EQ(visits, 1);
  for (const int visits : visit.node_visits) EXPECT_EQ(visits, 1);
  EXPECT_EQ(visit.leaves, bvh.leaf_count);
  EXPECT_TRUE(std::is_sorted(visit.depths.begin(), visit.depths.end()));
  EXPECT_EQ(visit.depths.back() + 1, bvh.depth);
}

TEST(Bvh, HoldsEveryTriangleOnceInTightBoxes) {
  for (const test::SoupKind kind : test::soup_kinds()) {
    for (const std::uint32_t count : {1u, 2u, 8u, 9u, 65u, 3000u}) {
      SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + " of " +
                   std::to_string(count));
      expect_sound(arrays_of(test::soup(kind, count, count)).view());
    }
  }
}

TEST(Bvh, OfNoTrianglesIsEmpty) {
  const Bvh bvh = build_bvh(Executor(2), TriangleView{});
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_EQ(bvh.depth, 0u);
}

TEST(Bvh, EqualTrianglesAreHalvedNotPeeled) {
  Mesh mesh;
  for (int i = 0; i < 20000; ++i) test::add_triangle(&mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  SceneDescription scene;
  test::add_mesh(&scene, std::move(mesh));
  const FlatArrays triangles = arrays_of(scene);
  expect_sound(triangles.view());
  EXPECT_LE(build_bvh(Executor(2), triangles.view()).depth, 5u);
}

TEST(Bvh, ExtremeCoordinatesAreSplit) {
  Mesh mesh;
  test::Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random.in_box(i % 2 == 0 ? 9e17f : 1e-30f);
    test::add_triangle(&mesh, p, p * 0.5f, random.in_box(1e-38f));
  }
  SceneDescription scene;
  test::add_mesh(&scene, std::move(mesh));
  expect_sound(arrays_of(scene).view());
}

void expect_same(const Bvh& a, const Bvh& b) {
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.depth, b.depth);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BvhNode)), 0);
}

TEST(Bvh, IsTheSameWithAnyNumberOfThreadsAndOfEitherLayout) {
  const FlatArrays scene = arrays_of(test::soup(test::SoupKind::kSmall, 70000, 9));
  const Bvh one = build_bvh(Executor(1), scene.view());
  for (const std::uint32_t threads : {2u, 5u})
    expect_same(build_bvh(Executor(threads), scene.view()), one);
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i < scene.view().count; ++i)
    for (int k = 0; k < 3; ++k) corners.push_back(scene.view().corner(i, k));
  expect_same(build_bvh(Executor(2), View<const Vec3>(corners)), one);
}

TEST(Bvh, CutsSpaceWell) {
  // Unit cells in a row: boxes of equal depth overlap little, so the sum of half areas stays small.
  Mesh mesh;
  for (int i = 0; i < 4096; ++i) {
    const auto x = static_cast<float>((i * 2731) % 4096);
    test::add_triangle(&mesh, {x, 0, 0}, {x + 1, 0, 0}, {x, 1, 1});
  }
  SceneDescription scene;
  test::add_mesh(&scene, std::move(mesh));
  const FlatArrays triangles = arrays_of(scene);
  const Bvh bvh = build_bvh(Executor(2), triangles.view());
  double length = 0;
  for (const BvhNode& node : bvh.nodes)
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (node.is_leaf(c)) length += double{node.box(c).max.x} - node.box(c).min.x;
  EXPECT_LT(length, 1.01 * 4096);
}

}  // namespace
}  // namespace raysheaf
