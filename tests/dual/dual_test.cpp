// Every query of `dual` gives brute force's answers bit for bit, for all kinds of triangles, trees
// and bundles.
#include "methods/dual/dual.h"

#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

TEST(Dual, AllShapes) {
  Random random(1);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Soup soup = make_soup(shape, 300, random);
    std::vector<Ray> rays = any_rays(soup, 700, random);
    EXPECT_GT(expect_right(soup, rays), 20u);
    turn_into_one_quarter(&rays);
    EXPECT_GT(expect_right(soup, rays), 20u);
  }
}

TEST(Dual, HitsAtTheirLimits) {
  Random random(2);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Soup soup = make_soup(shape, 200, random);
    std::vector<Ray> rays = any_rays(soup, 400, random);
    keep_one_hit(soup, &rays, random);
    expect_right(soup, rays);
  }
}

TEST(Dual, AllQuarters) {
  Random random(3);
  const Soup soup = make_soup(Shape::kLarge, 100, random);
  std::vector<Ray> rays;
  for (std::uint32_t q = 0; q < kQuarters; ++q) {
    for (std::uint32_t i = 0; i < 20 + q; ++i) {
      Vec3 d{1, random.unit(), random.unit()};
      if ((q & 4) != 0) d.x = -d.x;
      if ((q & 2) != 0) d.y = -d.y;
      if ((q & 1) != 0) d.z = -d.z;
      if (q / 8 == 1) d = {d.z, d.x, d.y};
      if (q / 8 == 2) d = {d.y, d.z, d.x};
      EXPECT_EQ(quarter_of(d), q);
      rays.push_back({random.in_box(12), 0, d, kInfinity});
    }
  }
  EXPECT_GT(expect_right(soup, rays), rays.size());
}

TEST(Dual, Sizes) {
  Random random(4);
  for (const std::size_t rays : {0, 1, 15, 16, 17, 4095, 4097, 10000}) {
    SCOPED_TRACE(rays);
    const Soup soup = make_soup(Shape::kSmall, rays < 1000 ? 100 : 20, random);
    expect_right(soup, any_rays(soup, rays, random));
    // Rays of a single quarter, which fill whole streams.
    std::vector<Ray> alike = any_rays(soup, rays, random);
    for (Ray& ray : alike) ray.direction = Vec3{2, 1, 1} + random.in_box(0.5f);
    expect_right(soup, alike);
  }
}

TEST(Dual, Facing) {
  Random random(5);
  for (const Shape shape : {Shape::kSmall, Shape::kLarge, Shape::kLattice, Shape::kClosed}) {
    Soup soup = make_soup(shape, 200, random);
    for (std::uint32_t i = 0; i < soup.count(); ++i)
      soup.flags.push_back(static_cast<std::uint8_t>(random.below(4)));
    const std::vector<Ray> rays = any_rays(soup, 500, random);
    const std::size_t some = expect_right(soup, rays, Facing::kSkipBackOfSingleSided);
    EXPECT_LT(some, expect_right(soup, rays, Facing::kBoth));
  }
}

/// Copies are decided without computing their distance again; what differs a little is not a copy.
TEST(Dual, CopiesOfTriangles) {
  Random random(28);
  for (const Shape shape : {Shape::kSmall, Shape::kLarge, Shape::kLattice}) {
    const Soup originals = make_soup(shape, 30, random);
    Soup soup;
    for (int i = 0; i < 600; ++i) {
      auto [a, b, c] = originals.corners(random.below(originals.count()));
      if (i % 4 == 1) std::swap(b, c);
      if (i % 4 == 2) c.z = std::nextafter(c.z, kInfinity);
      soup.add(a, b, c);
    }
    std::vector<Ray> rays = any_rays(soup, 500, random);
    for (const bool of_one_start : {false, true}) {
      for (Ray& ray : rays) ray.origin = of_one_start ? rays[0].origin : ray.origin;
      soup.flags.clear();
      expect_right(soup, rays);
      for (std::uint32_t i = 0; i < soup.count(); ++i)
        soup.flags.push_back(static_cast<std::uint8_t>(random.below(4)));
      expect_right(soup, rays, Facing::kSkipBackOfSingleSided);
    }
  }
}

/// A triangle that stops a ray is tested with its neighbours, whichever side of it they see.
TEST(Dual, RaysThatStopWhereTheirNeighboursDo) {
  Random random(27);
  const std::vector<Ray> rays = fan_rays(100);
  Soup soup = screened_soup(12, 300, random);
  for (std::uint32_t i = 0; i < soup.count(); ++i)
    soup.flags.push_back(static_cast<std::uint8_t>(random.below(4)));
  const std::size_t some = expect_right(soup, rays, Facing::kSkipBackOfSingleSided);
  EXPECT_GT(some, rays.size() / 4);
  EXPECT_LT(some, expect_right(soup, rays, Facing::kBoth));
}

/// Streams whose rays share their start compute planes through it; a ray that starts elsewhere, if
/// only by the sign of a zero, ends that.
TEST(Dual, RaysOfOneOrigin) {
  Random random(28);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Soup soup = make_soup(shape, 300, random);
    for (const Vec3 from : {Vec3{0.0f, -0.0f, 0.0f}, random.in_box(2), random.in_box(40)}) {
      std::vector<Ray> rays = any_rays(soup, 250, random);
      start_at(from, random.below(2) == 0 ? 0.0f : 0.9f, &rays);
      expect_right(soup, rays);
      rays.back().origin.y = -rays.back().origin.y;
      expect_right(soup, rays);
      rays[rays.size() / 2].origin += random.in_box(0.5f);
      expect_right(soup, rays);
      rays[0].t_min = 0.5f;
      expect_right(soup, rays);
    }
  }
}

/// From a corner, from a point of an edge, from within a triangle's plane; each ray ends at a hit.
TEST(Dual, RaysOfOneOriginOnTriangles) {
  Random random(29);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Soup soup = make_soup(shape, 200, random);
    for (int i = 0; i < 3; ++i) {
      const auto [a, b, c] = soup.corners(random.below(soup.count()));
      std::vector<Ray> rays = any_rays(soup, 200, random);
      start_at(i == 0 ? a : i == 1 ? (a + b) * 0.5f : a + (b - a) * 3 - (c - a), 0, &rays);
      expect_right(soup, rays);
      const HitRows rows = brute_force(soup, rays);
      for (std::size_t r = 0; r < rays.size(); ++r)
        if (!rows[r].empty()) rays[r].t_max = rows[r][rows[r].size() / 2].t;
      expect_right(soup, rays);
      for (Ray& ray : rays) ray.t_max = std::max(0.0f, std::nextafter(ray.t_max, 0.0f));
      expect_right(soup, rays);
    }
  }
}

TEST(Dual, NoTriangles) {
  Random random(6);
  Soup none, flat;
  flat.add({1, 2, 3}, {2, 4, 6}, {3, 6, 9});
  const std::vector<Ray> rays = any_rays(flat, 100, random);
  EXPECT_EQ(expect_right(none, rays), 0u);
  EXPECT_EQ(expect_right(flat, rays), 0u);
}

/// Every ray from inside a closed surface hits it, through edges and vertices too.
TEST(Dual, Watertight) {
  Random random(7);
  Soup soup;
  add_closed(12, &soup);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto t = soup.corners(random.below(soup.count()));
    const Vec3 o = random.in_box(2), at = i % 2 == 0 ? t[i % 3] : (t[0] + t[1]) * 0.5f;
    rays.push_back({o, 0, at - o, kInfinity});
  }
  for (const auto& row : brute_force(soup, rays)) EXPECT_FALSE(row.empty());
  expect_right(soup, rays);
  start_at(random.in_box(2), 0, &rays);
  for (const auto& row : brute_force(soup, rays)) EXPECT_FALSE(row.empty());
  expect_right(soup, rays);
}

/// More triangles than fit into caches: single rays wait longer for others. Streams and bundles do
/// not share state.
TEST(Dual, TreeFarFromCache) {
  Random random(11);
  Soup soup;
  while (soup.count() < 450'000) {
    const Vec3 p = random.in_box(10);
    soup.add(p, p + random.in_box(0.1f), p + random.in_box(0.1f));
  }
  const TriangleSource source = soup.source(5000);
  const Executor& executor = one_thread();
  ObjectTree tree;
  build_object_tree(executor, source, &tree);
  ASSERT_GT(tree.nodes.size() * sizeof(BvhNode) + tree.quads.size() * sizeof(TriangleQuad),
            std::size_t{16} << 20);
  std::vector<Ray> rays;
  for (int i = 0; i < 6000; ++i)
    rays.push_back({random.in_box(12), 0, random.direction(), kInfinity});
  DualScene scene{.tree = &tree, .bundle = Bundle::kLongStream};
  const Answers lists = ask(executor, scene, rays, Sorting::kByQuarter);
  scene.bundle = Bundle::kStream;
  const Answers streams = ask(executor, scene, rays, Sorting::kCurve);
  EXPECT_GT(hit_count(lists.all), rays.size() / 2);
  EXPECT_TRUE(right(lists.all, lists, rays));
  EXPECT_TRUE(right(lists.all, streams, rays));
  const std::vector<Ray> few(rays.begin(), rays.begin() + 30);
  EXPECT_TRUE(right(brute_force(soup, few), ask(executor, scene, few, Sorting::kCurve), few));
}

/// Nodes of seven leaves and a deeper node that is visited first: the waiting nodes exceed any
/// fixed stack.
TEST(Dual, DeepTree) {
  constexpr std::uint32_t kDepth = 150;
  Soup soup;
  ObjectTree tree;
  tree.nodes.resize_uninitialized(kDepth);
  tree.quads.resize_uninitialized(7 * kDepth);
  tree.bounds = {{-9, -9, 0}, {9, 9, kDepth}};
  tree.triangles = 7 * kDepth;
  for (std::uint32_t n = 0; n < kDepth; ++n) {
    BvhNode& node = tree.nodes[n];
    node.children = n + 1 < kDepth ? 8 : 7;
    const auto z = static_cast<float>(kDepth - n);
    for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
      const bool leaf = c < 7, none = c >= node.children;
      const float low[] = {-9, -9, leaf ? z : 0}, high[] = {9, 9, leaf ? z : z - 1};
      for (int axis = 0; axis < 3; ++axis) {
        node.bound[axis][c] = none ? kInfinity : low[axis];
        node.bound[3 + axis][c] = none ? -kInfinity : high[axis];
      }
      node.first[c] = none ? 0 : leaf ? 7 * n + c : n + 1;
      node.count[c] = leaf ? 1 : 0;
      if (!leaf) continue;
      TriangleQuad& quad = tree.quads[7 * n + c];
      const Vec3 corner[] = {{-9, -9, z}, {9, -9, z}, {static_cast<float>(c), 9, z}};
      for (int k = 0; k < 3; ++k)
        for (int lane = 0; lane < 4; ++lane)
          for (int axis = 0; axis < 3; ++axis)
            quad.vertex[k][axis][lane] = component(corner[k], axis);
      for (std::uint32_t& id : quad.id) id = soup.count();
      soup.add(corner[0], corner[1], corner[2]);
    }
  }
  // Bundles of sixteen rays and a few single ones along the axis; and rays that start behind all
  // nodes except the first.
  Random random(8);
  std::vector<Ray> rays;
  for (int i = 0; i < 163; ++i)
    rays.push_back({{random.between(-6, 6), random.between(-6, 6), i < 100 ? -1.0f : kDepth - 3.5f},
                    0,
                    {random.between(-1e-3f, 1e-3f), random.between(-1e-3f, 1e-3f), 1},
                    kInfinity});
  const HitRows rows = brute_force(soup, rays);
  EXPECT_GT(hit_count(rows), 50000u);
  for (const Bundle bundle : {Bundle::kStream, Bundle::kLongStream}) {
    const DualScene scene{&tree, nullptr, Facing::kBoth, bundle};
    EXPECT_TRUE(right(rows, ask(one_thread(), scene, rays, Sorting::kByQuarter), rays));
    const std::vector<Ray> few(rays.begin(), rays.begin() + 3);
    EXPECT_TRUE(right(rows, ask(one_thread(), scene, few, Sorting::kCurve), few));
  }
}

TEST(Dual, PositionsInGeometricSequence) {
  Random random(9);
  Soup soup;
  for (int i = 0; i < 900; ++i) {
    const float at = std::pow(1.06f, static_cast<float>(i - 450));
    soup.add(Vec3{at, at, 0}, Vec3{at, -at, at * 0.1f}, Vec3{at * 1.01f, 0, -at});
  }
  std::vector<Ray> rays = any_rays(soup, 300, random);
  for (int i = 0; i < 100; ++i)
    rays.push_back(
        {{}, 0, {1, random.between(-0.5f, 0.5f), random.between(-0.1f, 0.1f)}, kInfinity});
  EXPECT_GT(expect_right(soup, rays), 5000u);
}

}  // namespace
}  // namespace raysheaf::test
