#include "object_tree/bvh.h"

#include <gtest/gtest.h>

#include <cstring>

#include "emulated/emulated_device.h"
#include "object_tree/bvh_device.h"
#include "scene/flat_arrays.h"
#include "support/guarded_memory.h"
#include "support/soups.h"

namespace raysheaf {
namespace {

FlatArrays flat(const SceneDescription& scene) {
  const Executor executor(2);
  return {executor, flatten(executor, scene, mesh_bounds(executor, scene))};
}

/// Follows the tree from the root: counts how often each triangle and each node is reached, and
/// checks that every box contains the boxes below it.
struct Visit {
  const Bvh& bvh;
  const TriangleView& scene;
  std::vector<int> triangle_visits, node_visits;
  std::uint32_t leaves = 0;

  Visit(const Bvh& tree, const TriangleView& triangles)
      : bvh(tree),
        scene(triangles),
        triangle_visits(triangles.count),
        node_visits(tree.nodes.size()) {
    if (!bvh.nodes.empty()) (void)node(0, 0);
  }

  Box node(std::uint32_t number, std::uint32_t depth) {
    ++node_visits[number];
    EXPECT_GE(number, bvh.level_starts[depth]);
    EXPECT_LT(number, bvh.level_starts[depth + 1]);
    const BvhNode& n = bvh.nodes[number];
    EXPECT_GE(n.children, 1u);
    EXPECT_LE(n.children, kBvhWidth);
    Box all;
    for (std::uint32_t c = 0; c < n.children; ++c) {
      const Box inside = n.is_leaf(c) ? leaf(n, c) : node(n.first[c], depth + 1);
      const Vec3 low{n.bound[0][c], n.bound[1][c], n.bound[2][c]};
      const Vec3 high{n.bound[3][c], n.bound[4][c], n.bound[5][c]};
      EXPECT_TRUE(low == inside.min && high == inside.max) << "node " << number << " child " << c;
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
  EXPECT_EQ(bvh.level_starts.back(), bvh.nodes.size());
}

TEST(Bvh, HoldsEveryTriangleOnceInTightBoxes) {
  for (const test::SoupKind kind : test::soup_kinds()) {
    for (const std::uint32_t count : {1u, 2u, 8u, 9u, 65u, 3000u}) {
      SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + " of " +
                   std::to_string(count));
      expect_sound(flat(test::soup(kind, count, count)).view());
    }
  }
}

TEST(Bvh, OfNoTrianglesIsEmpty) {
  const Bvh bvh = build_bvh(Executor(2), TriangleView{});
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_EQ(bvh.depth(), 0u);
}

TEST(Bvh, EqualTrianglesAreHalvedNotPeeled) {
  Mesh mesh;
  for (int i = 0; i < 20000; ++i) test::add_triangle(&mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  SceneDescription scene;
  test::add_mesh(&scene, std::move(mesh));
  const FlatArrays triangles = flat(scene);
  expect_sound(triangles.view());
  EXPECT_LE(build_bvh(Executor(2), triangles.view()).depth(), 5u);
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
  expect_sound(flat(scene).view());
}

TEST(Bvh, IsTheSameWithAnyNumberOfThreads) {
  const FlatArrays scene = flat(test::soup(test::SoupKind::kSmall, 30000, 9));
  const Bvh one = build_bvh(Executor(1), scene.view());
  for (const std::uint32_t threads : {2u, 5u}) {
    const Bvh many = build_bvh(Executor(threads), scene.view());
    EXPECT_EQ(one.triangles, many.triangles);
    EXPECT_EQ(one.level_starts, many.level_starts);
    ASSERT_EQ(one.nodes.size(), many.nodes.size());
    EXPECT_EQ(std::memcmp(one.nodes.data(), many.nodes.data(), one.nodes.size() * sizeof(BvhNode)),
              0);
  }
}

/// Also after a larger scene, whose memory is used again.
void expect_same_there(const TriangleView& scene, HostAllocator& memory,
                       BvhOn<EmulatedDevice>* there) {
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i < scene.count; ++i)
    for (int k = 0; k < 3; ++k) corners.push_back(scene.corner(i, k));
  DeviceBuffer<Vec3> copy(memory);
  copy.resize_uninitialized("copy", corners.size());
  {
    const test::Reach reach(memory);
    std::copy(corners.begin(), corners.end(), copy.data());
  }
  there->build({copy.view_const(), {}});
  const Bvh here = build_bvh(Executor(2), scene);
  EXPECT_EQ(there->depth(), here.depth());
  EXPECT_EQ(there->leaf_count(), here.leaf_count);
  ASSERT_EQ(there->nodes().size, here.nodes.size());
  const test::Reach reach(memory);
  for (std::size_t i = 0; i < here.triangles.size(); ++i)
    ASSERT_EQ(there->triangles()[i], here.triangles[i]) << i;
  for (std::size_t n = 0; n < here.nodes.size(); ++n) {
    const BvhNode &a = there->nodes()[n], &b = here.nodes[n];
    ASSERT_EQ(a.children, b.children) << n;
    for (std::uint32_t c = 0; c < b.children; ++c) {
      ASSERT_EQ(a.first[c], b.first[c]) << n;
      ASSERT_EQ(a.count[c], b.count[c]) << n;
      for (int k = 0; k < 6; ++k) ASSERT_EQ(a.bound[k][c], b.bound[k][c]) << n;
    }
  }
}

TEST(Bvh, IsTheSameOnADevice) {
  const Executor executor(2);
  test::GuardedMemory memory;
  EmulatedDevice device(executor, memory);
  BvhOn<EmulatedDevice> there(device);
  for (const test::SoupKind kind : test::soup_kinds()) {
    for (const std::uint32_t count : {3000u, 1u, 2u, 8u, 9u, 65u}) {
      SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + " of " +
                   std::to_string(count));
      expect_same_there(flat(test::soup(kind, count, count)).view(), memory, &there);
    }
  }
  Mesh equal;
  for (int i = 0; i < 700; ++i) test::add_triangle(&equal, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  SceneDescription scene;
  test::add_mesh(&scene, std::move(equal));
  expect_same_there(flat(scene).view(), memory, &there);
  there.build({});
  EXPECT_TRUE(there.nodes().empty());
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
  const FlatArrays triangles = flat(scene);
  const Bvh bvh = build_bvh(Executor(2), triangles.view());
  double length = 0;
  for (const BvhNode& node : bvh.nodes)
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (node.is_leaf(c)) length += double{node.bound[3][c]} - node.bound[0][c];
  EXPECT_LT(length, 1.01 * 4096);
}

}  // namespace
}  // namespace raysheaf
