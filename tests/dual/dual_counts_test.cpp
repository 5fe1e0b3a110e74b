// Counts of a query are within limits, add up over rays, and are the same for any number of
// threads.
#include "base/bits.h"
#include "dual/dual_scenes.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

struct Setting {
  Tree tree;
  Bundle bundle;
  Sorting sorting;
};
constexpr Setting kSettings[] = {{Tree::kCurve, Bundle::kStream, Sorting::kByQuarter},
                                 {Tree::kFine, Bundle::kStream, Sorting::kCurve},
                                 {Tree::kCoarse, Bundle::kStream, Sorting::kCurve},
                                 {Tree::kCoarse, Bundle::kLongStream, Sorting::kByQuarter},
                                 {Tree::kJoined, Bundle::kStream, Sorting::kByQuarter},
                                 {Tree::kRefitted, Bundle::kStream, Sorting::kByQuarter},
                                 {Tree::kCurve, Bundle::kLongStream, Sorting::kCurve},
                                 {Tree::kFine, Bundle::kLongStream, Sorting::kByQuarter}};

/// Groups of 16 coherent rays, so that beams are narrow.
std::vector<Ray> camera_rays(std::uint32_t side) {
  std::vector<Ray> rays;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(side) - 0.5f;
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(side) - 0.5f;
      rays.push_back({{0.3f, 0.2f, 40}, 0, {u, v, -1}, kInfinity});
    }
  return rays;
}

/// Compares answers and counts on every SIMD target and on two threads with the first.
void expect_same_everywhere(Soup soup, const std::vector<Ray>& rays) {
  const HitRows rows = brute_force(soup, rays);
  for (const Setting& s : kSettings) {
    ObjectTree tree;
    make_tree(&soup, s.tree, &tree);
    const DualScene scene{&tree, nullptr, Facing::kBoth, s.bundle};
    const Answers first = ask(one_thread(), scene, rays, s.sorting);
    EXPECT_TRUE(right(rows, first, rays));
    for_each_simd_target([&](const char* target) {
      const Answers a = ask(one_thread(), scene, rays, s.sorting);
      EXPECT_TRUE(right(rows, a, rays)) << target;
      EXPECT_TRUE(same(first, a)) << target << " tree " << static_cast<int>(s.tree) << " bundle "
                                  << static_cast<int>(s.bundle);
    });
    EXPECT_TRUE(same(first, ask(two_threads(), scene, rays, s.sorting)));
  }
}

TEST(DualCounts, SameOnEverySimdTargetAndThreads) {
  Random random(21);
  for (const Shape shape : kShapes) {
    Soup soup = make_soup(shape, 250, random);
    std::vector<Ray> rays = any_rays(soup, 200, random);
    const std::vector<Ray> alike = camera_rays(16);
    rays.insert(rays.end(), alike.begin(), alike.end());
    std::vector<Ray> turned(rays.begin(), rays.begin() + 150);
    turn_into_one_quarter(&turned);
    rays.insert(rays.end(), turned.begin(), turned.end());
    SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(shape));
    expect_same_everywhere(soup, rays);
    start_at({0.3f, 0.2f, 12}, 0, &rays);
    expect_same_everywhere(soup, rays);
  }
}

TEST(DualCounts, SameOnEverySimdTargetAtTheEndsOfTheRange) {
  Random random(22);
  for (const float scale : {1e-15f, 1e15f, 1e35f}) {
    Soup soup = make_soup(Shape::kSmall, 150, random, scale);
    std::vector<Ray> rays = any_rays(soup, 300, random, scale);
    for (std::size_t i = 0; i < rays.size(); i += 7) {
      rays[i].direction = rays[i].direction * (1e-40f / max_component(abs(rays[i].direction)));
      if (!(max_component(abs(rays[i].direction)) > 0)) rays[i].direction = {0, 1e-42f, 0};
      rays[i].t_max = kInfinity;
    }
    expect_same_everywhere(soup, rays);
    start_at(random.in_box(12) * scale, 0, &rays);
    expect_same_everywhere(soup, rays);
  }
}

/// Many tasks, so that threads process them in different orders.
TEST(DualCounts, SameWithAnyThreads) {
  Random random(23);
  Soup soup = make_soup(Shape::kSmall, 3000, random);
  const std::vector<Ray> rays = any_rays(soup, 30000, random);
  for (const Setting& s : kSettings) {
    ObjectTree tree;
    make_tree(&soup, s.tree, &tree);
    const DualScene scene{&tree, nullptr, Facing::kBoth, s.bundle};
    EXPECT_TRUE(same(ask(one_thread(), scene, rays, s.sorting),
                     ask(two_threads(), scene, rays, s.sorting)));
  }
}

TEST(DualCounts, WithinBounds) {
  Random random(24);
  Soup soup = make_soup(Shape::kSmall, 2000, random);
  const std::vector<Ray> rays = any_rays(soup, 3000, random);
  for (const Setting& s : kSettings) {
    ObjectTree tree;
    make_tree(&soup, s.tree, &tree);
    std::uint64_t children = 0;
    for (const BvhNode& node : tree.nodes) children += node.children;
    const DualScene scene{&tree, nullptr, Facing::kBoth, s.bundle};
    const Answers a = ask(one_thread(), scene, rays, s.sorting);
    const std::uint64_t bundles = div_ceil(rays.size(), 16) + kQuarters;
    for (std::size_t q = 0; q < 3; ++q) {
      const DualCounts& c = a.counts[q];
      EXPECT_GE(c.ray_box_tests, rays.size());
      EXPECT_LE(c.ray_box_tests, rays.size() * (1 + children));
      EXPECT_LE(c.triangle_tests, rays.size() * tree.triangles);
      EXPECT_LE(c.beam_box_tests, bundles * children);
      if (s.bundle == Bundle::kStream) {
        EXPECT_GT(c.beam_box_tests, 0u);
      }
      // The tree must save most of the tests.
      EXPECT_LT(c.sum(), rays.size() * tree.triangles / 4);
      double shares = 0;
      for (const float share : a.ray_tests[q]) shares += static_cast<double>(share);
      EXPECT_NEAR(shares, static_cast<double>(c.sum()), 1e-4 * static_cast<double>(c.sum()));
    }
    EXPECT_GE(a.counts[0].triangle_tests,
              static_cast<std::uint64_t>(
                  std::count_if(a.closest.begin(), a.closest.end(),
                                [](const IndexedHit& h) { return h.triangle != kInvalidId; })));
    EXPECT_GE(a.counts[2].triangle_tests, hit_count(a.all));
    EXPECT_GE(a.counts[2].sum(), a.counts[0].sum());
    EXPECT_GE(a.counts[0].triangle_tests, a.counts[1].triangle_tests);
  }
}

TEST(DualCounts, ABeamSavesTestsOfItsRays) {
  Random random(25);
  Soup soup = make_soup(Shape::kSmall, 3000, random);
  const std::vector<Ray> rays = camera_rays(64);
  std::vector<Ray> apart(rays.size());  // neighbours from everywhere
  for (std::size_t i = 0; i < rays.size(); ++i) apart[i * 1021 % rays.size()] = rays[i];
  ObjectTree tree;
  make_tree(&soup, Tree::kFine, &tree);
  const DualScene scene{&tree, nullptr, Facing::kBoth, Bundle::kStream};
  const DualCounts alike = ask(one_thread(), scene, rays, Sorting::kByQuarter).counts[0];
  const DualCounts mixed = ask(one_thread(), scene, apart, Sorting::kByQuarter).counts[0];
  EXPECT_LT(alike.ray_box_tests, mixed.ray_box_tests * 3 / 4);
}

/// Closest hits and any hits of fan rays in long streams, behind `screens` large triangles.
Answers ask_behind(std::uint32_t screens) {
  Random random(28);
  Soup soup = screened_soup(screens, 3000, random);
  ObjectTree tree;
  make_tree(&soup, Tree::kCurve, &tree);
  const DualScene scene{&tree, nullptr, Facing::kBoth, Bundle::kLongStream};
  return ask(one_thread(), scene, fan_rays(128), Sorting::kByQuarter);
}

TEST(DualCounts, APilotSavesTestsOfItsNeighbours) {
  const Answers a = ask_behind(60);
  EXPECT_LT(a.counts[1].ray_box_tests, a.counts[0].ray_box_tests / 2);
}

TEST(DualCounts, PilotsThatSaveNoTestsStayFew) {
  const Answers a = ask_behind(0);
  EXPECT_LT(a.counts[1].sum(), a.counts[0].sum());
}

/// Long streams are split where a quarter has many rays and near the batch's end, whichever thread
/// processes them.
TEST(DualCounts, LongStreamsAreTheSameOnAnyThreads) {
  Random random(29);
  Soup soup = make_soup(Shape::kSmall, 2000, random);
  ObjectTree tree;
  make_tree(&soup, Tree::kFine, &tree);
  std::vector<Ray> rays = any_rays(soup, 60000, random);
  std::vector<Ray> turned(rays.begin(), rays.begin() + 40000);
  turn_into_one_quarter(
      &turned);  // more of them than the quarters' share, in streams of equal length
  rays.insert(rays.end(), turned.begin(), turned.end());
  DualScene scene{.tree = &tree, .bundle = Bundle::kStream};
  const Answers streams = ask(one_thread(), scene, rays, Sorting::kByQuarter);
  scene.bundle = Bundle::kLongStream;
  const Answers one = ask(one_thread(), scene, rays, Sorting::kByQuarter);
  EXPECT_TRUE(right(streams.all, one, rays));
  EXPECT_TRUE(same(one, ask(two_threads(), scene, rays, Sorting::kByQuarter)));
  EXPECT_EQ(one.counts[0].beam_box_tests, 0u);
}

/// Shares are added to existing values; both shares and counts are optional.
TEST(DualCounts, AreOptional) {
  Random random(26);
  Soup soup = make_soup(Shape::kSmall, 100, random);
  const std::vector<Ray> rays = any_rays(soup, 100, random);
  ObjectTree tree;
  make_tree(&soup, Tree::kCurve, &tree);
  const RayOrder order = order_of(one_thread(), rays, Sorting::kCurve);
  for (const Bundle bundle : {Bundle::kStream, Bundle::kLongStream}) {
    const DualScene scene{&tree, nullptr, Facing::kBoth, bundle};
    std::vector<IndexedHit> with(rays.size()), without(rays.size());
    std::vector<float> tests(rays.size(), 1000);
    DualCounts counts;
    trace_rays(one_thread(), scene, View<const Ray>(rays), order,
               {.hits = with, .ray_tests = tests}, &counts);
    trace_rays(one_thread(), scene, View<const Ray>(rays), order, {.hits = without}, nullptr);
    EXPECT_TRUE(std::equal(with.begin(), with.end(), without.begin(), same_bits));
    for (const float t : tests) EXPECT_GT(t, 1000);
  }
}

}  // namespace
}  // namespace raysheaf::test
