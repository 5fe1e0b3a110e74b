// Checks the contract of the object tree on random and adversarial triangles, whether it was
// rebuilt, built finely or refitted.
#include "object_tree/object_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <random>

#include "base/bits.h"
#include "object_tree/fine_build.h"
#include "scene/flatten_body.h"
#include "support/random.h"

namespace raysheaf::test {
namespace {

using Index = std::array<std::uint32_t, 3>;

/// Triangles of one or several runs: each mesh has separate positions, indexed or not.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Index> indices;  ///< empty: three positions per triangle
};

struct Case {
  std::vector<Mesh> meshes;
  std::vector<TriangleRun> runs;

  TriangleSource source() {
    runs.clear();
    std::uint32_t first = 0;
    for (const Mesh& m : meshes) {
      const auto count =
          static_cast<std::uint32_t>(m.indices.empty() ? m.positions.size() / 3 : m.indices.size());
      if (count == 0) continue;
      runs.push_back(
          {m.positions.data(), m.indices.empty() ? nullptr : m.indices.data(), first, count});
      first += count;
    }
    return {runs, first, nullptr};
  }
};

Mesh soup(std::uint32_t count, float half, float size, unsigned seed) {
  Random random(seed);
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 at = random.in_box(half);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(at + random.in_box(size));
  }
  return mesh;
}

Mesh grid(std::uint32_t side, float bump) {
  Random random(side);
  Mesh mesh;
  for (std::uint32_t y = 0; y <= side; ++y)
    for (std::uint32_t x = 0; x <= side; ++x)
      mesh.positions.push_back(
          {static_cast<float>(x), random.between(-bump, bump), static_cast<float>(y)});
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x, b = a + side + 1;
      mesh.indices.push_back({a, a + 1, b});
      mesh.indices.push_back({b, a + 1, b + 1});
    }
  return mesh;
}

Mesh copies(std::uint32_t count) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
  mesh.indices.assign(count, {0, 1, 2});
  return mesh;
}

Mesh points(std::uint32_t count) {
  Mesh mesh = soup(count, 10, 0, 4);
  return mesh;
}

Mesh moved(Mesh mesh, Vec3 by, float scale) {
  for (Vec3& p : mesh.positions) p = p * scale + by;
  return mesh;
}

/// Every second triangle becomes degenerate: two equal corners, or three collinear ones.
Mesh half_flat(Mesh mesh) {
  for (std::size_t i = 0; i + 5 < mesh.positions.size(); i += 6) {
    Vec3* p = &mesh.positions[i];
    if (i % 12 == 0) {
      p[1] = p[0];
    } else {
      p[0] = {1, 2, 3}, p[1] = {2, 4, 6}, p[2] = {4, 8, 12};
    }
  }
  return mesh;
}

/// Every fifth triangle becomes a line.
Mesh fifth_flat(Mesh mesh) {
  for (std::size_t t = 0; t < mesh.indices.size(); t += 5) mesh.indices[t][2] = mesh.indices[t][1];
  return mesh;
}

/// Every third four of triangles has no area.
Mesh fours_flat(Mesh mesh) {
  for (std::size_t t = 0; t < mesh.indices.size(); ++t)
    if (t / 4 % 3 == 1) mesh.indices[t][2] = mesh.indices[t][1];
  return mesh;
}

Mesh shuffled(Mesh mesh) {
  std::shuffle(mesh.indices.begin(), mesh.indices.end(), std::mt19937(1));
  return mesh;
}

Mesh slivers(std::uint32_t count) {
  Random random(9);
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 a = random.in_box(100), b = random.in_box(100);
    mesh.positions.insert(mesh.positions.end(), {a, b, a + random.in_box(1e-3f)});
  }
  return mesh;
}

std::vector<Case> cases() {
  std::vector<Case> all(26);
  all[0].meshes = {soup(1, 1, 1, 1)};
  all[1].meshes = {soup(2, 1, 1, 2)};
  all[2].meshes = {soup(9, 1, 1, 3)};
  all[3].meshes = {soup(3000, 10, 0.3f, 5)};
  all[4].meshes = {grid(40, 0.2f), soup(700, 30, 2, 6), copies(3)};
  all[5].meshes = {copies(1000)};
  all[6].meshes = {points(100)};
  all[7].meshes = {};
  all[8].meshes = {half_flat(soup(2000, 1, 1, 7)), grid(10, 0)};
  all[9].meshes = {slivers(2000)};
  all[10].meshes = {soup(2000, 1e6f, 1e-1f, 8),
                    moved(soup(2000, 1, 1e-2f, 9), {5e5f, 0, 0}, 1e-3f)};
  all[11].meshes = {moved(soup(2000, 1, 0.1f, 10), {}, 1e-20f)};
  all[12].meshes = {moved(soup(2000, 1, 0.1f, 11), {}, 4e17f)};
  all[13].meshes = {soup(1, 1, 1e5f, 12), soup(5000, 1, 1e-3f, 13)};
  all[14].meshes = {moved(soup(500, 1, 0.1f, 14), {}, 1e-42f), moved(copies(20), {0, 0, 0}, 1e-3f)};
  all[15].meshes = {grid(3, 0), soup(20000, 10, 0.1f, 15)};
  all[16].meshes = {moved(soup(600, 1, 0.1f, 14), {}, 1e-3f),
                    moved(soup(600, 1, 0.1f, 14), {1e15f, 1e15f, 0}, 1)};
  all[17].meshes = {soup(110000, 10, 0.05f, 16), half_flat(soup(120000, 10, 0.05f, 17))};
  all[18].meshes = {grid(90, 0.1f)};
  all[19].meshes = {fifth_flat(grid(70, 0.1f)), soup(300, 40, 1, 18), grid(1, 0)};
  all[20].meshes = {moved(grid(50, 0.1f), {1e6f, 0, -1e6f}, 1), moved(grid(9, 0), {}, 1e-25f)};
  all[21].meshes = {grid(130, 0.1f), soup(8000, 200, 1, 19)};
  // Most triangles in a small part of the box of all.
  all[22].meshes = {soup(3, 1, 1e4f, 20), soup(30000, 1, 1e-2f, 21), copies(9000)};
  all[23].meshes = {moved(grid(200, 0.1f), {3, 3, 3}, 1e-4f), soup(3, 1, 1e4f, 22)};
  all[24].meshes = {copies(70000)};
  all[25].meshes = {fours_flat(grid(60, 0.1f))};
  return all;
}

Box box_of(const std::array<Vec3, 3>& c) {
  return {min(min(c[0], c[1]), c[2]), max(max(c[0], c[1]), c[2])};
}

void grow(Box* box, const Box& other) {
  box->min = min(box->min, other.min);
  box->max = max(box->max, other.max);
}

Box child_box(const BvhNode& node, std::uint32_t c) {
  return {{node.bound[0][c], node.bound[1][c], node.bound[2][c]},
          {node.bound[3][c], node.bound[4][c], node.bound[5][c]}};
}

/// Follows the tree from its root and checks each node.
class Walk {
 public:
  Walk(const ObjectTree& tree, const TriangleSource& source)
      : tree_(tree), source_(source), seen_(source.count) {
    if (tree.empty()) return;
    expect_same(visit(0, 0), tree.bounds);
    EXPECT_EQ(tree.triangles,
              static_cast<std::uint32_t>(std::count(seen_.begin(), seen_.end(), 1)));
  }

  [[nodiscard]] bool seen(std::uint32_t triangle) const { return seen_[triangle] != 0; }
  [[nodiscard]] std::uint32_t depth() const { return depth_; }
  [[nodiscard]] std::uint32_t leaves() const { return leaves_; }

 private:
  static void expect_same(const Box& a, const Box& b) {
    EXPECT_TRUE(a.min == b.min && a.max == b.max);
  }

  Box visit(std::uint32_t n, std::uint32_t depth) {
    Box whole;
    if (n >= tree_.nodes.size() || depth > 200) {
      ADD_FAILURE() << "node " << n << " at depth " << depth;
      return whole;
    }
    depth_ = std::max(depth_, depth + 1);
    const BvhNode& node = tree_.nodes[n];
    EXPECT_LE(node.children, kBvhWidth);
    EXPECT_GE(node.children, n == 0 ? 1u : 2u);
    for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
      if (c >= node.children) {
        expect_same(child_box(node, c), Box{});
        EXPECT_EQ(node.first[c], 0u);
        EXPECT_EQ(node.count[c], 0u);
        continue;
      }
      EXPECT_TRUE(node.is_leaf(c) || node.first[c] > n);
      const Box below =
          node.is_leaf(c) ? leaf(node.first[c], node.count[c]) : visit(node.first[c], depth + 1);
      expect_same(child_box(node, c), below);
      grow(&whole, below);
    }
    return whole;
  }

  Box leaf(std::uint32_t first, std::uint32_t count) {
    ++leaves_;
    Box box;
    EXPECT_LE(count, kCoarseTriangles);
    for (std::uint32_t i = 0; i < 4 * div_ceil(count, 4); ++i) {
      if (first + i / 4 >= tree_.quads.size()) {
        ADD_FAILURE() << "quad " << first + i / 4;
        return box;
      }
      const TriangleQuad& quad = tree_.quads[first + i / 4];
      const std::uint32_t id = quad.id[i % 4];
      std::array<Vec3, 3> held;
      for (std::size_t k = 0; k < 3; ++k)
        held[k] = {quad.vertex[k][0][i % 4], quad.vertex[k][1][i % 4], quad.vertex[k][2][i % 4]};
      const std::array<Vec3, 3> wanted = corners(id);
      EXPECT_TRUE(held == wanted) << "triangle " << id;
      grow(&box, box_of(held));
      if (i >= count) {
        EXPECT_EQ(id, quad.id[0]);
      } else if (id < seen_.size()) {
        EXPECT_EQ(seen_[id]++, 0) << "triangle " << id << " twice";
      }
    }
    return box;
  }

  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t id) const {
    const TriangleRun& run = source_.runs[source_.run_of(id)];
    std::array<Vec3, 3> c = run.corners(id - run.first);
    if (has_no_area(c[0], c[1], c[2])) c[1] = c[2] = c[0];
    return c;
  }

  const ObjectTree& tree_;
  const TriangleSource& source_;
  std::vector<std::uint8_t> seen_;
  std::uint32_t depth_ = 0, leaves_ = 0;
};

bool flat(const TriangleSource& source, std::uint32_t id) {
  const TriangleRun& run = source.runs[source.run_of(id)];
  const std::array<Vec3, 3> c = run.corners(id - run.first);
  return has_no_area(c[0], c[1], c[2]);
}

void expect_right(const ObjectTree& tree, const TriangleSource& source) {
  const Walk walk(tree, source);
  for (std::uint32_t id = 0; id < source.count; ++id)
    ASSERT_EQ(walk.seen(id), !flat(source, id)) << "triangle " << id;
  EXPECT_EQ(tree.empty(), tree.triangles == 0);
  EXPECT_EQ(tree.surface_area_cost > 0, tree.triangles > 0);
  EXPECT_LE(walk.depth(), 60u);
  EXPECT_LE(walk.leaves(), tree.triangles);
}

/// Compares all bytes except the padding: `used` bytes of each record.
template <class Record>
bool same_bytes(const Buffer<Record>& a, const Buffer<Record>& b, std::size_t used) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const Record& x, const Record& y) {
    return std::memcmp(&x, &y, used) == 0;
  });
}
bool same_bytes(const Buffer<TriangleQuad>& a, const Buffer<TriangleQuad>& b) {
  return same_bytes(a, b, offsetof(TriangleQuad, reach) + sizeof(TriangleQuad::reach));
}
bool same_bytes(const Buffer<BvhNode>& a, const Buffer<BvhNode>& b) {
  return same_bytes(a, b, offsetof(BvhNode, children) + sizeof(BvhNode::children));
}

using Build = void (*)(const Executor&, const TriangleSource&, ObjectTree*);

void build(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  build_object_tree(executor, source, tree);
}
void build_coarsely(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  build_object_tree(executor, source, tree, {kCoarseTriangles});
}

/// Whether or not the source's triangles follow each other.
template <std::uint32_t kTriangles, Joining kJoining>
void build_joined(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  build_object_tree(executor, source, tree, {kTriangles, kJoining});
}

class ObjectTreeOf : public testing::TestWithParam<Build> {};
const char* const kBuildNames[] = {"Rebuild", "Coarse", "Fine",         "Single",
                                   "Strips",  "Leaves", "CoarseStrips", "CoarseLeaves"};
INSTANTIATE_TEST_SUITE_P(, ObjectTreeOf,
                         testing::Values(&build, &build_coarsely, &build_fine_object_tree,
                                         &build_joined<kQuadTriangles, Joining::kNone>,
                                         &build_joined<kQuadTriangles, Joining::kStrips>,
                                         &build_joined<kQuadTriangles, Joining::kLeaves>,
                                         &build_joined<kCoarseTriangles, Joining::kStrips>,
                                         &build_joined<kCoarseTriangles, Joining::kLeaves>),
                         [](const auto& of) { return kBuildNames[of.index]; });

/// The surface of all boxes within a cube around the origin.
double surface_within(const ObjectTree& tree, float half) {
  double sum = 0;
  for (const BvhNode& node : tree.nodes)
    for (std::uint32_t c = 0; c < node.children; ++c) {
      const Box box = child_box(node, c);
      const Vec3 size = box.max - box.min;
      if (max_component(max(abs(box.min), abs(box.max))) > half) continue;
      sum += double{size.x} * size.y + double{size.y} * size.z + double{size.z} * size.x;
    }
  return sum;
}

TEST_P(ObjectTreeOf, IsAsGoodBesideLargeTrianglesAndOtherScenesFarAway) {
  const Executor executor(2);
  const Mesh ground{{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, {{0, 2, 1}, {0, 3, 2}}};
  for (const Mesh& mesh : {grid(150, 0.2f), shuffled(grid(150, 0.2f)), soup(20000, 10, 0.1f, 23)}) {
    Case alone{{mesh}, {}};
    ObjectTree tree;
    GetParam()(executor, alone.source(), &tree);
    const double surface = surface_within(tree, 1e3f);
    for (const float far : {1e4f, 1e6f, 1e12f}) {
      SCOPED_TRACE(far);
      for (const Mesh& other : {moved(ground, {0, -1, 0}, far), moved(mesh, {0, far, far}, 1)}) {
        Case beside{{mesh, other}, {}};
        GetParam()(executor, beside.source(), &tree);
        EXPECT_LT(surface_within(tree, 1e3f), 1.25 * surface);
      }
    }
  }
}

TEST_P(ObjectTreeOf, HoldsEveryTriangleWithAreaOnceInExactBoxes) {
  const Executor executor(2);
  ObjectTree used;
  std::vector<Case> all = cases();
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    const TriangleSource source = all[i].source();
    GetParam()(executor, source, &used);
    expect_right(used, source);
  }
}

/// A grid in pieces of three cells, each far from the last.
Mesh grid_in_pieces(std::uint32_t side) {
  Mesh mesh = grid(side, 0.1f);
  const std::vector<std::array<std::uint32_t, 3>> cells = mesh.indices;
  const std::size_t pieces = cells.size() / 6;
  for (std::size_t i = 0; i < 6 * pieces; ++i)
    mesh.indices[i] = cells[i / 6 * 617 % pieces * 6 + i % 6];
  return mesh;
}

TEST(ObjectTree, TrianglesThatFollowEachOtherOnASurfaceAreJoined) {
  const Executor executor(2);
  Case in_order, in_none, in_pieces;
  in_order.meshes = {grid(100, 0.1f)};
  in_none.meshes = {shuffled(in_order.meshes[0])};
  in_pieces.meshes = {grid_in_pieces(100)};
  EXPECT_EQ(joining_of(in_order.source()), Joining::kLeaves);
  EXPECT_EQ(joining_of(in_pieces.source()), Joining::kStrips);
  EXPECT_EQ(joining_of(in_none.source()), Joining::kNone);
  ObjectTree joined, sorted;
  build_object_tree(executor, in_order.source(), &joined);
  build_object_tree(executor, in_none.source(), &sorted);
  EXPECT_LE(joined.quads.size(), joined.triangles / 3.8);
  EXPECT_GE(sorted.quads.size(), sorted.triangles / 3.8);
  EXPECT_LE(joined.surface_area_cost, 1.02f * sorted.surface_area_cost);
}

TEST(ObjectTree, JoinedLeavesHaveTheirQuadsInTheOrderOfTheSource) {
  Case one;
  one.meshes = {grid(100, 0.1f)};
  ObjectTree tree;
  build_coarsely(Executor(2), one.source(), &tree);
  std::uint32_t next = 0;
  for (const TriangleQuad& quad : tree.quads)
    for (const std::uint32_t id : quad.id) EXPECT_EQ(id, next++);
  EXPECT_EQ(next, tree.triangles);
}

TEST(ObjectTree, CoarseTreesHaveFewNodesAndFullQuads) {
  const Executor executor(2);
  std::vector<Case> all(3);
  all[0].meshes = {grid(100, 0.1f)};
  all[1].meshes = {shuffled(grid(100, 0.1f))};
  all[2].meshes = {soup(20000, 10, 0.1f, 15)};
  for (Case& one : all) {
    ObjectTree tree, coarse;
    build(executor, one.source(), &tree);
    build_coarsely(executor, one.source(), &coarse);
    EXPECT_LE(coarse.nodes.size(), tree.nodes.size() / 2);
    EXPECT_LE(coarse.quads.size(), tree.quads.size());
    EXPECT_LE(coarse.quads.size(), coarse.triangles / 3.2);
  }
}

TEST_P(ObjectTreeOf, IsTheSameWithAnyNumberOfThreadsAndInUsedMemory) {
  std::vector<Case> all = cases();
  ObjectTree used;
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    const TriangleSource source = all[i].source();
    ObjectTree one;
    GetParam()(Executor(1), source, &one);
    GetParam()(Executor(3), source, &used);
    EXPECT_TRUE(same_bytes(one.nodes, used.nodes));
    EXPECT_TRUE(same_bytes(one.quads, used.quads));
    EXPECT_EQ(one.left_out, used.left_out);
    EXPECT_EQ(one.surface_area_cost, used.surface_area_cost);
  }
}

/// Long runs are cut by all threads.
TEST(ObjectTree, FineTreeOfManyTrianglesIsRightAndTheSameWithAnyNumberOfThreads) {
  Case many;
  many.meshes = {soup(70000, 10, 0.1f, 16)};
  ObjectTree one, three;
  build_fine_object_tree(Executor(1), many.source(), &one);
  build_fine_object_tree(Executor(3), many.source(), &three);
  expect_right(one, many.source());
  EXPECT_TRUE(same_bytes(one.nodes, three.nodes));
  EXPECT_TRUE(same_bytes(one.quads, three.quads));
}

TEST_P(ObjectTreeOf, RefittedHoldsTheNewCorners) {
  const Executor executor(2);
  std::vector<Case> all = cases();
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    ObjectTree tree;
    GetParam()(executor, all[i].source(), &tree);
    for (Mesh& mesh : all[i].meshes)
      for (Vec3& p : mesh.positions) p = p * 0.5f;
    ASSERT_TRUE(refit_object_tree(executor, all[i].source(), MovedTriangles::everything(), &tree));
    if (i != 14) expect_right(tree, all[i].source());  // halves of subnormal numbers are rounded
  }
}

TEST_P(ObjectTreeOf, RefittedToTheSameCornersIsTheSame) {
  const Executor executor(2);
  std::vector<Case> all = cases();
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    ObjectTree built, refitted;
    GetParam()(executor, all[i].source(), &built);
    GetParam()(executor, all[i].source(), &refitted);
    ASSERT_TRUE(
        refit_object_tree(executor, all[i].source(), MovedTriangles::everything(), &refitted));
    EXPECT_TRUE(same_bytes(built.nodes, refitted.nodes));
    EXPECT_TRUE(same_bytes(built.quads, refitted.quads));
    EXPECT_FLOAT_EQ(built.surface_area_cost, refitted.surface_area_cost);
  }
}

/// Halves some of a case's triangles, or a whole mesh if they share corners; returns which.
MovedTriangles some_halved(Case* one, Random* random) {
  MovedTriangles moved;
  const TriangleSource source = one->source();
  for (std::size_t m = 0, r = 0; m < one->meshes.size(); ++m) {
    std::vector<Vec3>& positions = one->meshes[m].positions;
    if (r == source.runs.size || source.runs[r].positions != positions.data()) continue;
    const TriangleRun& run = source.runs[r++];
    TriangleRange range{run.first, run.count};
    std::size_t begin = 0, end = positions.size();
    if (run.triangles == nullptr) {
      const std::uint32_t first = random->below(run.count);
      range = {run.first + first,
               1 + random->below(std::min(run.count - first, run.count / 9 + 1))};
      begin = std::size_t{3} * first, end = begin + std::size_t{3} * range.count;
    } else if (random->below(2) == 0) {
      continue;
    }
    for (std::size_t i = begin; i < end; ++i) positions[i] = positions[i] * 0.5f;
    moved.add(range, source.count);
  }
  return moved;
}

TEST_P(ObjectTreeOf, RefittedWhereTrianglesMovedIsAsRefittedWhole) {
  const Executor executor(2);
  Random random(3);
  std::vector<Case> all = cases();
  std::size_t in_part = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    ObjectTree whole, part;
    GetParam()(executor, all[i].source(), &whole);
    GetParam()(executor, all[i].source(), &part);
    for (int turn = 0; turn < 3; ++turn) {
      const MovedTriangles moved = some_halved(&all[i], &random);
      in_part += moved.all() ? 0 : 1;
      const TriangleSource source = all[i].source();
      const bool refitted =
          refit_object_tree(executor, source, MovedTriangles::everything(), &whole);
      ASSERT_EQ(refit_object_tree(executor, source, moved, &part), refitted);
      if (!refitted) break;
      EXPECT_TRUE(same_bytes(whole.nodes, part.nodes));
      EXPECT_TRUE(same_bytes(whole.quads, part.quads));
      EXPECT_EQ(whole.surface_area_cost, part.surface_area_cost);
    }
  }
  EXPECT_GT(in_part, all.size());
}

TEST(MovedTriangles, HoldWhatWasAdded) {
  Random random(4);
  for (const std::uint32_t count : {1u, 63u, 64u, 65u, 1000u}) {
    MovedTriangles moved;
    std::vector<bool> expected(count);
    std::uint32_t sum = 0;
    for (int i = 0; i < 4 && !moved.all(); ++i) {
      const std::uint32_t first = random.below(count);
      const TriangleRange range{first, random.below(count - first + 1) / 8};
      moved.add(range, count);
      sum += range.count;
      for (std::uint32_t t = first; t < first + range.count; ++t) expected[t] = true;
      for (std::uint32_t t = 0; t < count && !moved.all(); ++t)
        ASSERT_EQ(moved.has(t), expected[t]) << t << " of " << count;
    }
    EXPECT_EQ(moved.all(), sum > 0 && sum >= count / 2);
    moved.clear();
    EXPECT_FALSE(moved.all() || moved.has(0));
  }
}

TEST_P(ObjectTreeOf, RefittedKeepsTrianglesThatLostTheirArea) {
  const Executor executor(2);
  Case one;
  one.meshes = {soup(3000, 10, 0.5f, 20)};
  ObjectTree tree;
  GetParam()(executor, one.source(), &tree);
  one.meshes[0] = half_flat(one.meshes[0]);
  ASSERT_TRUE(refit_object_tree(executor, one.source(), MovedTriangles::everything(), &tree));
  const TriangleSource source = one.source();
  const Walk walk(tree, source);
  for (std::uint32_t id = 0; id < source.count; ++id) EXPECT_TRUE(walk.seen(id));
  one.meshes = {soup(3000, 10, 0.5f, 21)};
  ASSERT_TRUE(refit_object_tree(executor, one.source(), MovedTriangles::everything(), &tree));
  expect_right(tree, one.source());
}

TEST_P(ObjectTreeOf, RefittedSaysWhenATriangleGainsArea) {
  const Executor executor(2);
  Case one;
  one.meshes = {half_flat(soup(3000, 10, 0.5f, 20))};
  ObjectTree tree;
  GetParam()(executor, one.source(), &tree);
  EXPECT_EQ(tree.left_out.size(), 1500u);
  EXPECT_TRUE(refit_object_tree(executor, one.source(), MovedTriangles::everything(), &tree));
  one.meshes[0].positions[6 * 1499 + 1] = {100, 3, 5};
  EXPECT_FALSE(refit_object_tree(executor, one.source(), MovedTriangles::everything(), &tree));
}

constexpr Joining kJoinings[] = {Joining::kNone, Joining::kStrips, Joining::kLeaves};

TEST(ObjectTree, TrianglesWithoutAreaThatAreKeptArePointsAndMayGainAnArea) {
  const Executor executor(2);
  std::vector<Case> all = cases();
  for (const Joining joining : kJoinings)
    for (const std::uint32_t most : {kQuadTriangles, kCoarseTriangles})
      for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE(i);
        const TriangleSource source = all[i].source();
        ObjectTree tree;
        build_object_tree(executor, source, &tree, {most, joining, true});
        EXPECT_TRUE(tree.left_out.empty());
        const Walk walk(tree, source);
        for (std::uint32_t id = 0; id < source.count; ++id) ASSERT_TRUE(walk.seen(id)) << id;
      }
  for (const Joining joining : kJoinings) {
    const Mesh solid = soup(3000, 10, 0.5f, 20);
    Case one;
    one.meshes = {half_flat(solid)};
    ObjectTree tree;
    build_object_tree(executor, one.source(), &tree, {kQuadTriangles, joining, true});
    one.meshes = {solid};
    ASSERT_TRUE(refit_object_tree(executor, one.source(), MovedTriangles::everything(), &tree));
    expect_right(tree, one.source());
  }
}

/// Builds finely in slices of `ns`, and calls `between()` after each.
template <class Between>
std::size_t build_in_slices(const Executor& executor, double ns, const TriangleSource& source,
                            const ObjectTree& tree, FineBuild* build, const Between& between) {
  std::size_t slices = 0;
  double saved = 0;
  for (build->begin(tree); !build->is_complete(); ++slices) {
    saved += ns - build->advance(executor, source, tree, saved + ns);
    EXPECT_GE(saved, 0);
    EXPECT_LE(saved, ns + 2.5e6) << "steps take at most about two milliseconds";
    between();
  }
  return slices;
}

TEST(FineBuild, IsTheSameInSlicesAsAtOnce) {
  std::vector<Case> all = cases();
  std::size_t most = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    const TriangleSource source = all[i].source();
    ObjectTree whole, sliced;
    build_fine_object_tree(Executor(3), source, &whole);
    build_object_tree(Executor(2), source, &sliced);
    if (sliced.empty()) continue;
    FineBuild build;
    most = std::max(most, build_in_slices(Executor(2), 1e5, source, sliced, &build, [] {}));
    ASSERT_TRUE(build.finish(Executor(2), source, &sliced));
    EXPECT_FALSE(build.has_begun());
    EXPECT_TRUE(same_bytes(whole.nodes, sliced.nodes));
    EXPECT_TRUE(same_bytes(whole.quads, sliced.quads));
    EXPECT_EQ(whole.surface_area_cost, sliced.surface_area_cost);
  }
  EXPECT_GT(most, 500u);
}

TEST(FineBuild, HoldsTheCornersOfTheLastFrameIfTrianglesMove) {
  const Executor executor(2);
  for (const std::size_t i : {3u, 15u, 19u, 23u}) {
    SCOPED_TRACE(i);
    Random random(static_cast<unsigned>(i));
    Case one = cases()[i];
    ObjectTree tree;
    build_object_tree(executor, one.source(), &tree);
    FineBuild build;
    const TriangleSource source = one.source();
    const std::size_t slices = build_in_slices(executor, 1e6, source, tree, &build, [&] {
      build.triangles_moved();
      for (Mesh& mesh : one.meshes)
        for (Vec3& p : mesh.positions) p = p * random.between(0.999f, 1.001f);
      ASSERT_TRUE(refit_object_tree(executor, one.source(), MovedTriangles::everything(), &tree));
    });
    EXPECT_GT(slices, 1u);
    const float before = tree.surface_area_cost;
    ASSERT_TRUE(build.finish(executor, one.source(), &tree));
    expect_right(tree, one.source());
    EXPECT_LT(tree.surface_area_cost, 1.3f * before);
  }
}

}  // namespace
}  // namespace raysheaf::test
