// The engine during a scene's life: triangles are added, moved and removed between queries.
#include "queries/planned_queries.h"

#include <memory>
#include <numeric>

#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

/// A scene whose arrays are overwritten and freed before the engine gets the next ones.
class Stage {
 public:
  void set(Soup soup, bool same) {
    if (soup_ != nullptr) {
      for (Vec3& p : soup_->positions) p = {kInfinity, -kInfinity, kInfinity};
      for (auto& triangle : soup_->indices) triangle = {0x7fffffff, 0x7fffffff, 0x7fffffff};
      for (TriangleRun& run : soup_->runs) run = {nullptr, nullptr, 0x7fffffff, 0};
    }
    soup_ = std::make_unique<Soup>(std::move(soup));
    engine.set_triangles(soup_->source(), same);
  }
  [[nodiscard]] const Soup& soup() const { return *soup_; }

  PlannedQueries engine;

 private:
  std::unique_ptr<Soup> soup_;
};

struct Batch {
  std::vector<IndexedHit> closest;
  std::vector<std::uint8_t> any;
  HitRows all;  ///< by ray
  QueryReport reports[3];
};

/// Puts each hit in its place.
HitSink into(std::vector<IndexedHit>& hits) {
  return [&hits](std::size_t begin, View<const IndexedHit> found) {
    std::copy(found.begin(), found.end(), hits.begin() + static_cast<std::ptrdiff_t>(begin));
  };
}

Batch ask_engine(const Executor& executor, PlannedQueries* engine, std::vector<Ray> rays,
                 Facing facing = Facing::kBoth) {
  PlannedOptions options{facing, true};
  options.whole = true;
  const RaysInPlace source{View<const Ray>(rays)};
  Batch b;
  b.closest.assign(rays.size(), {-1, -1, -1, 7});
  b.any.assign(rays.size(), 7);
  engine->any_hit(executor, source, options, b.any, &b.reports[1]);
  engine->closest_hit(executor, source, options, into(b.closest), &b.reports[0]);
  b.all.resize(rays.size());
  const FoundRows found = engine->all_hits(executor, source, options, &b.reports[2]);
  found.for_each(executor, [&](std::size_t ray, View<const IndexedHit> hits) {
    b.all[ray].assign(hits.begin(), hits.end());
  });
  return b;
}

testing::AssertionResult right(const HitRows& rows, const Batch& b, const std::vector<Ray>& rays) {
  Answers a;
  a.closest = b.closest;
  a.any = b.any;
  a.all = b.all;  // not sorted as required, or wrong
  return test::right(rows, a, rays);
}

void expect_engine_right(Stage* stage, const std::vector<Ray>& rays,
                         Facing facing = Facing::kBoth) {
  const HitRows rows = brute_force(stage->soup(), rays, facing);
  EXPECT_TRUE(right(rows, ask_engine(two_threads(), &stage->engine, rays, facing), rays));
}

bool said(const QueryReport& report, const std::string& text) {
  return std::any_of(report.plan.begin(), report.plan.end(), [&](const std::string& reason) {
    return reason.find(text) != std::string::npos;
  });
}

Soup moved(Soup soup, float by, Random& random) {
  for (Vec3& p : soup.positions) p += random.in_box(by);
  return soup;
}

/// Rays from one origin, of an image, or incoherent ones.
std::vector<Ray> some_rays(const Soup& soup, Random& random) {
  if (soup.count() == 0) return {{{}, 0, {0, 0, 1}, kInfinity}};
  std::vector<Ray> rays = any_rays(soup, 20 + random.below(400), random);
  const std::uint32_t kind = random.below(3);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (kind == 0) rays[i].origin = rays[0].origin;
    if (kind == 1) {
      const float x = static_cast<float>(i) / static_cast<float>(rays.size());
      rays[i] = {{x, 0, 30}, 0, {x - 0.5f, random.between(-0.2f, 0.2f), -1}, kInfinity};
    }
  }
  return rays;
}

TEST(PlannedQueries, ALifeOfMovesAndReplacements) {
  std::uint32_t refitted = 0, finely = 0, built = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Random random(seed);
    Stage stage;
    for (int step = 0; step < 40; ++step) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " step " << step);
      const std::uint32_t what = step == 0 ? 0 : random.below(8);
      if (what == 0) {
        const Shape shape = kShapes[random.below(std::size(kShapes))];
        stage.set(make_soup(shape, 1 + random.below(200), random), false);
      } else if (what < 5) {
        stage.set(moved(stage.soup(), random.below(4) == 0 ? 10 : 0.1f, random), true);
      } else if (what == 5) {
        // Reports the triangles as the same, but there are more.
        Soup more = stage.soup();
        add_random(Shape::kSmall, random, &more);
        stage.set(more, true);
      }
      if (random.below(3) == 0) continue;
      const std::vector<Ray> rays = some_rays(stage.soup(), random);
      const HitRows rows = brute_force(stage.soup(), rays);
      const Batch b = ask_engine(two_threads(), &stage.engine, rays);
      ASSERT_TRUE(right(rows, b, rays));
      for (const QueryReport& report : b.reports) {
        refitted += said(report, "refitted,") ? 1 : 0;
        finely += said(report, "a slice of it is built") ? 1 : 0;
        built += said(report, "are new") ? 1 : 0;
      }
    }
  }
  EXPECT_GT(refitted, 6u);
  EXPECT_GT(built, 6u);
  EXPECT_GT(finely, 6u);
}

TEST(PlannedQueries, NoTrianglesAndNoRays) {
  Random random(7);
  Stage stage;
  stage.set({}, false);
  expect_engine_right(&stage, {});
  const std::vector<Ray> rays{{{}, 0, {1, 0, 0}, kInfinity}, {{1, 2, 3}, 0, {0, 1, 0}, 1}};
  expect_engine_right(&stage, rays);
  Soup flat;
  flat.add({1, 2, 3}, {2, 4, 6}, {3, 6, 9});
  stage.set(flat, false);
  expect_engine_right(&stage, rays);
  // A degenerate triangle gains an area and loses it, although triangles are reported as moved.
  for (int i = 0; i < 4; ++i) {
    stage.set(make_soup(Shape::kSingle, 1, random), true);
    expect_engine_right(&stage, any_rays(stage.soup(), 50, random));
    stage.set(flat, true);
    expect_engine_right(&stage, rays);
  }
  stage.set({}, true);
  expect_engine_right(&stage, rays);
}

TEST(PlannedQueries, Facing) {
  Random random(8);
  Stage stage;
  for (int frame = 0; frame < 6; ++frame) {
    Soup soup = make_soup(Shape::kSmall, 150, random);
    for (std::uint32_t i = 0; i < soup.count(); ++i)
      soup.flags.push_back(static_cast<std::uint8_t>(random.below(4)));
    stage.set(soup, frame % 3 != 0);
    const std::vector<Ray> rays = some_rays(soup, random);
    expect_engine_right(&stage, rays, Facing::kSkipBackOfSingleSided);
    expect_engine_right(&stage, rays, Facing::kBoth);
  }
}

TEST(PlannedQueries, RowsWithTies) {
  Random random(9);
  Stage stage;
  stage.set(make_soup(Shape::kDuplicates, 300, random), false);
  std::vector<Ray> rays;
  for (int i = 0; i < 300; ++i)
    rays.push_back({lattice_point(random), 0, {0, 0, i % 2 == 0 ? 1.0f : -1.0f}, kInfinity});
  std::size_t ties = 0;
  stage.engine.all_hits(one_thread(), RaysInPlace(rays), {}, nullptr)
      .for_each(one_thread(), [&](std::size_t, View<const IndexedHit> hits) {
        for (std::size_t i = 1; i < hits.size; ++i) {
          EXPECT_TRUE(precedes(hits[i - 1], hits[i]));
          ties += hits[i - 1].t == hits[i].t ? 1 : 0;
        }
      });
  EXPECT_GT(ties, 100u);
  expect_engine_right(&stage, rays);
}

/// Most rays share an origin, but one of them starts elsewhere.
TEST(PlannedQueries, AlmostOneOrigin) {
  Random random(21);
  Stage stage;
  stage.set(make_soup(Shape::kSmall, 2000, random), false);
  for (const std::size_t other : {1u, 1001u, 4999u}) {
    std::vector<Ray> rays = any_rays(stage.soup(), 5000, random);
    const Vec3 elsewhere = rays[other].origin;
    for (Ray& ray : rays) ray.origin = {};
    rays[other].origin = elsewhere;
    std::vector<std::uint8_t> occluded(rays.size(), 7);
    stage.engine.any_hit(two_threads(), RaysInPlace(rays), {}, occluded, nullptr);
    const HitRows rows = brute_force(stage.soup(), rays, Facing::kBoth);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_EQ(occluded[i] != 0, !rows[i].empty()) << "ray " << i;
  }
}

TEST(PlannedQueries, SharesAddUp) {
  Random random(10);
  for (const bool one_origin : {false, true}) {
    Stage stage;
    stage.set(make_soup(Shape::kSmall, 2000, random), false);
    std::vector<Ray> rays = any_rays(stage.soup(), 2000, random);
    for (Ray& ray : rays)
      if (one_origin) ray.origin = {};
    PlannedOptions options{Facing::kBoth, true};
    std::vector<IndexedHit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    QueryReport closest, any;
    std::vector<float> a(rays.size(), 0), b(rays.size(), 0);
    options.ray_tests = b;
    stage.engine.any_hit(one_thread(), RaysInPlace(rays), options, occluded, &any);
    options.ray_tests = a;
    stage.engine.closest_hit(one_thread(), RaysInPlace(rays), options, into(hits), &closest);
    const auto sum = [](const std::vector<float>& v) {
      return std::accumulate(v.begin(), v.end(), 0.0);
    };
    const auto tests = static_cast<double>(closest.tests());
    EXPECT_GT(tests, 0);
    EXPECT_NEAR(sum(a), tests, 1e-4 * tests);
    EXPECT_GT(any.tests(), 0u);
    EXPECT_NEAR(sum(b), static_cast<double>(any.tests()), 1e-3 * static_cast<double>(any.tests()));
  }
}

TEST(PlannedQueries, SameWithAnyThreads) {
  Random random(11);
  Stage a, b;
  Soup soup = make_soup(Shape::kSmall, 3000, random);
  for (int frame = 0; frame < 8; ++frame) {
    a.set(soup, frame > 0);
    b.set(soup, frame > 0);
    const std::vector<Ray> rays = some_rays(soup, random);
    const Batch one = ask_engine(one_thread(), &a.engine, rays);
    const Batch two = ask_engine(two_threads(), &b.engine, rays);
    for (int q = 0; q < 3; ++q) {
      EXPECT_EQ(one.reports[q].plan, two.reports[q].plan);
      EXPECT_EQ(one.reports[q].bound_tests, two.reports[q].bound_tests);
      EXPECT_EQ(one.reports[q].ray_bound_tests, two.reports[q].ray_bound_tests);
      EXPECT_EQ(one.reports[q].triangle_tests, two.reports[q].triangle_tests);
    }
    EXPECT_TRUE(std::equal(one.closest.begin(), one.closest.end(), two.closest.begin(), same_bits));
    EXPECT_EQ(one.any, two.any);
    for (std::size_t i = 0; i < rays.size(); ++i)
      EXPECT_TRUE(std::equal(one.all[i].begin(), one.all[i].end(), two.all[i].begin(),
                             two.all[i].end(), same_bits));
    soup = moved(soup, 0.05f, random);
  }
}

/// Closest hits of a thousand rays, frame by frame; counts how often a text was the plan's reason.
class Frames {
 public:
  void frame(const Soup& soup, bool same, Random& random) {
    stage_.set(soup, same);
    const std::vector<Ray> rays = any_rays(soup, 1000, random);
    std::vector<IndexedHit> hits(rays.size());
    QueryReport report;
    stage_.engine.closest_hit(one_thread(), RaysInPlace(rays), {}, into(hits), &report);
    reports_.push_back(report);
    memory_.push_back(stage_.engine.memory_bytes());
  }
  [[nodiscard]] std::size_t count(const std::string& text) const {
    return static_cast<std::size_t>(std::count_if(
        reports_.begin(), reports_.end(), [&](const QueryReport& r) { return said(r, text); }));
  }
  [[nodiscard]] const QueryReport& last() const { return reports_.back(); }
  [[nodiscard]] const std::vector<std::size_t>& memory() const { return memory_; }

 private:
  Stage stage_;
  std::vector<QueryReport> reports_;
  std::vector<std::size_t> memory_;
};

TEST(PlannedQueries, TrianglesThatKeepMovingGetAFineTreeOnce) {
  Random random(12);
  Frames frames;
  Soup soup = make_soup(Shape::kSmall, 500, random);
  for (int i = 0; i < 60; ++i) {
    frames.frame(soup, i > 0, random);
    soup = moved(soup, 1e-3f, random);
  }
  EXPECT_EQ(frames.count("are new"), 1u);
  EXPECT_EQ(frames.count("built finely"), 1u);
  EXPECT_EQ(frames.count("refitted"), 58u);
  EXPECT_GT(frames.count("a slice of it is built"), 3u);
  EXPECT_EQ(frames.count("degraded"), 0u);
  frames.frame(make_soup(Shape::kSmall, 500, random), false, random);
  EXPECT_TRUE(said(frames.last(), "are new"));
}

/// Triangles that swap places in each frame: no tree can be refitted, and fine ones are begun less
/// and less often.
TEST(PlannedQueries, DegradedTreesAreRebuiltAndFineOnesRarely) {
  Random random(13);
  Frames frames;
  for (int i = 0; i < 200; ++i) frames.frame(make_soup(Shape::kSmall, 500, random), i > 0, random);
  EXPECT_GT(frames.count("degraded"), 60u);
  EXPECT_GE(frames.count("a slice of it is built"), 1u);
  EXPECT_LE(frames.count("a slice of it is built"), 16u);
}

/// A tree that a large move has degraded is rebuilt if triangles then stay in place.
TEST(PlannedQueries, ADegradedTreeOfStaticTrianglesIsRebuilt) {
  Random random(17);
  for (const int moves : {1, 9}) {
    Stage stage;
    Soup soup = make_soup(Shape::kSmall, 500, random);
    const auto ask = [&] {
      const std::vector<Ray> rays = any_rays(stage.soup(), 50, random);
      std::vector<IndexedHit> hits(rays.size());
      QueryReport report;
      stage.engine.closest_hit(one_thread(), RaysInPlace(rays), {}, into(hits), &report);
      return report;
    };
    stage.set(soup, false);
    ask();
    for (int i = 1; i < moves; ++i) {
      stage.set(moved(soup, 1e-3f, random), true);
      ask();
    }
    stage.set(make_soup(Shape::kSmall, 500, random), true);
    EXPECT_TRUE(said(ask(), "refitted"));
    EXPECT_TRUE(said(ask(), "degraded"));
    EXPECT_TRUE(said(ask(), "kept"));
  }
}

/// Triangles whose area comes and goes cost one rebuild: from then on the tree holds them all.
TEST(PlannedQueries, FlickeringTrianglesCostOneRebuild) {
  Random random(14);
  Frames frames;
  const Soup soup = make_soup(Shape::kSmall, 500, random);
  for (int i = 0; i < 200; ++i) {
    Soup now = soup;
    for (std::uint32_t t = 0; t < soup.count(); ++t)
      if ((t + static_cast<std::uint32_t>(i)) % 3 == 0)
        now.positions[3 * t + 1] = now.positions[3 * t];
    frames.frame(now, i > 0, random);
  }
  EXPECT_EQ(frames.count("are new"), 1u);
  EXPECT_EQ(frames.count("gained an area"), 1u);
  EXPECT_LE(frames.count("built finely"), 2u);
  EXPECT_GT(frames.count("refitted"), 180u);
}

TEST(PlannedQueries, MemoryStaysOverFrames) {
  Random random(15);
  Frames moving, changing;
  Soup soup = make_soup(Shape::kSmall, 1000, random);
  for (int i = 0; i < 200; ++i) {
    moving.frame(soup, i > 0, random);
    soup = moved(soup, 0.01f, random);
    changing.frame(make_soup(Shape::kSmall, 1000, random), false, random);
  }
  EXPECT_LE(moving.memory()[199], moving.memory()[50] * 101 / 100);
  EXPECT_GT(moving.memory()[199], 1000u * 40);
  EXPECT_LT(changing.memory()[199], changing.memory()[50] * 11 / 10);
  // Shadow rays of one light.
  Stage stage;
  std::vector<std::size_t> memory;
  for (int i = 0; i < 100; ++i) {
    stage.set(soup, i > 0);
    std::vector<Ray> rays(3000);
    for (Ray& ray : rays) ray = {{0.1f, 0.2f, 0.3f}, 0, random.direction() * 20, 1};
    std::vector<std::uint8_t> occluded(rays.size());
    stage.engine.any_hit(one_thread(), RaysInPlace(rays), {}, occluded, nullptr);
    memory.push_back(stage.engine.memory_bytes());
  }
  EXPECT_LE(memory[99], memory[30] * 11 / 10);
}

TEST(PlannedQueries, ManyRaysOnTrianglesThatStayGetAFineTree) {
  Random random(16);
  Stage stage;
  stage.set(make_soup(Shape::kSmall, 50, random), false);
  const std::vector<Ray> rays = any_rays(stage.soup(), 20000, random);
  std::vector<IndexedHit> hits(rays.size()), first(rays.size());
  std::uint32_t finely = 0;
  for (int i = 0; i < 10; ++i) {
    QueryReport report;
    stage.engine.closest_hit(one_thread(), RaysInPlace(rays), {}, into(hits), &report);
    if (i == 0) first = hits;
    EXPECT_TRUE(std::equal(hits.begin(), hits.end(), first.begin(), same_bits));
    finely += said(report, "built finely") ? 1 : 0;
  }
  EXPECT_EQ(finely, 1u);
}

}  // namespace
}  // namespace raysheaf::test
