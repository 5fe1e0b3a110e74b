// The plan's choices for different rays and scenes.
#include "queries/plan.h"

#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

/// As many rays as an image has, row by row, from nearly one point.
std::vector<Ray> picture(std::uint32_t side) {
  std::vector<Ray> rays;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(side);
      const float v = static_cast<float>(y) / static_cast<float>(side);
      rays.push_back({{u, v, 0}, 0, {u - 0.5f, v - 0.5f, 1}, kInfinity});
    }
  return rays;
}

std::vector<Ray> disorder(std::size_t count, Random& random) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back({random.in_box(5), 0, random.direction(), kInfinity});
  return rays;
}

/// Origins along rows, random directions: ambient occlusion.
std::vector<Ray> scattered(std::uint32_t side, Random& random) {
  std::vector<Ray> rays = picture(side);
  for (Ray& ray : rays) ray.direction = random.direction();
  return rays;
}

SceneHistory history(std::uint32_t triangles) {
  SceneHistory scene;
  scene.triangles = triangles;
  return scene;
}

Plan plan_of(const SceneHistory& scene, const std::vector<Ray>& rays, bool any = false) {
  return make_plan(scene, RaysInPlace(View<const Ray>(rays)), any, true);
}

bool says(const Plan& plan, const std::string& text) {
  return std::any_of(plan.reasons.begin(), plan.reasons.end(), [&](const std::string& reason) {
    return reason.find(text) != std::string::npos;
  });
}

TEST(Plan, BundlesByCoherence) {
  Random random(2);
  const Plan camera = plan_of(history(1000), picture(128));
  EXPECT_EQ(camera.bundle, Bundle::kStream);
  EXPECT_EQ(plan_of(history(100000), picture(128)).bundle, Bundle::kStream);
  EXPECT_TRUE(says(camera, "start within"));
  EXPECT_TRUE(says(camera, "bundles: streams"));
  EXPECT_TRUE(camera.alike);
  const Plan any = plan_of(history(1000), disorder(10000, random));
  EXPECT_FALSE(any.alike);
  EXPECT_EQ(any.bundle, Bundle::kLongStream);
  EXPECT_TRUE(says(any, "extent apart"));
  EXPECT_TRUE(says(any, "long streams"));
  const Plan occlusion = plan_of(history(1000), scattered(128, random));
  EXPECT_FALSE(occlusion.alike);
  EXPECT_EQ(occlusion.bundle, Bundle::kLongStream);
  EXPECT_TRUE(says(occlusion, "only 0 % of neighbours"));
}

/// One of eight blocks of columns has scattered rays. No single block shows both kinds.
TEST(Plan, SamplesAllColumnsOfAnImage) {
  Random random(4);
  for (const std::size_t bad : {0u, 3u}) {
    std::vector<Ray> rays = picture(512);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (i / 64 % 8 == bad) rays[i].direction = random.direction();
    const Coherence found = sample_coherence(RaysInPlace(rays));
    EXPECT_GT(found.direction, 0.7);
    EXPECT_LT(found.direction, 1);
  }
}

TEST(Plan, GivenChoicesReplaceThoseOfThePlan) {
  const std::vector<Ray> rays = picture(128);
  const RaysInPlace source{View<const Ray>(rays)};
  const GivenChoices given{Bundle::kLongStream, false, TreeWork::kRebuildFinely};
  const Plan plan = make_plan(history(100000), source, false, true, given);
  EXPECT_EQ(plan.bundle, Bundle::kLongStream);
  EXPECT_FALSE(plan.alike);
  EXPECT_EQ(plan.tree, TreeWork::kRebuildFinely);
}

TEST(Plan, CoherenceOfOrders) {
  Random random(3);
  const std::vector<Ray> rays = disorder(50000, random);
  RayOrder order;
  order_rays(one_thread(), View<const Ray>(rays), Sorting::kCurve, &order);
  std::vector<Ray> ordered;
  for (const std::uint32_t number : order.rays) ordered.push_back(rays[number]);
  const Coherence before = sample_coherence(RaysInPlace(View<const Ray>(rays)));
  const Coherence after = sample_coherence(RaysInPlace(View<const Ray>(ordered)));
  EXPECT_GT(before.origin, 0.5);
  EXPECT_EQ(before.direction, 0);
  EXPECT_LT(after.origin, before.origin);
  EXPECT_GT(after.direction, before.direction);
  EXPECT_EQ(sample_coherence(RaysInPlace({})).origin, 0);
  for (const std::size_t few : {1, 15, 16, 17, 1023})
    EXPECT_LE(sample_coherence(RaysInPlace({rays.data(), few})).direction, 1);
}

TEST(Plan, RecognisesCoherentRays) {
  Random random(5);
  EXPECT_TRUE(plan_of(history(100000), picture(128)).alike);
  EXPECT_FALSE(plan_of(history(100000), scattered(128, random)).alike);
  EXPECT_FALSE(plan_of(history(100000), disorder(20000, random)).alike);
}

void expect_tree(const Plan& plan, TreeWork work, const char* text) {
  EXPECT_EQ(plan.tree, work) << text;
  EXPECT_TRUE(says(plan, text)) << text;
}

TEST(Plan, TreeByHistory) {
  Random random(4);
  const std::vector<Ray> rays = disorder(4000, random);
  SceneHistory scene = history(5000);
  const auto expect = [&](TreeWork work, const char* text) {
    expect_tree(plan_of(scene, rays), work, text);
  };
  const auto expect_finely = [&](TreeWork work, const char* text) {
    const Plan plan = plan_of(scene, rays);
    expect_tree(plan, work, text);
    EXPECT_TRUE(plan.finely && plan.slice_ns > 0) << text;
  };
  expect(TreeWork::kRebuild, "new");
  scene.built = true;
  expect(TreeWork::kKeep, "no triangle has moved");
  EXPECT_FALSE(plan_of(scene, rays).finely);
  scene.rays_since_change = 1000000000;
  expect_finely(TreeWork::kKeep, "so many rays");
  scene.fine = true;
  expect(TreeWork::kKeep, "no triangle has moved");
  scene.fine = false;
  scene.rays_since_change = 0;
  scene.moved = true;
  scene.moves = 1;
  expect(TreeWork::kRefit, "refitted");
  scene.moves = scene.patience;
  expect(TreeWork::kRefit, "refitted");
  scene.rays_between_changes = scene.triangles;
  expect_finely(TreeWork::kRefit, "keep moving");
  // A fine tree takes longer to refit, for which few rays do not pay.
  scene.joining = Joining::kStrips;
  scene.rays_between_changes = scene.triangles / 2;
  expect(TreeWork::kRefit, "refitted");
  scene.rays_between_changes = 10 * scene.triangles;
  expect_finely(TreeWork::kRefit, "keep moving");
  scene.joining = Joining::kNone;
  scene.fine = true;
  expect(TreeWork::kRefit, "refitted");
  scene.degraded = true;
  expect(TreeWork::kRebuild, "degraded");
  scene.moved = false;  // degraded, but needed again
  expect(TreeWork::kRebuild, "degraded");
  scene.rays_since_change = 1000000000;
  expect(TreeWork::kRebuild, "degraded");
  scene.fine = scene.degraded = false;  // after which it has small leaves again
  expect_finely(TreeWork::kKeep, "so many rays");
  scene.rays_since_change = 0;
  scene.moved = true;
  scene.patience = scene.moves + 10;
  scene.fine = scene.degraded = false;
  expect(TreeWork::kRefit, "refitted");
}

TEST(Plan, CoarseTreeForFewRays) {
  Random random(4);
  const std::vector<Ray> rays = disorder(10000, random);
  SceneHistory scene = history(100000);
  const auto expect = [&](TreeWork work, const char* text) {
    expect_tree(plan_of(scene, rays), work, text);
  };
  expect(TreeWork::kRebuildCoarsely, "large leaves");
  scene.rays_between_changes = 100000;  // so many came for the former triangles
  expect(TreeWork::kRebuild, "new");
  scene.rays_between_changes = 0;
  scene.built = scene.coarse = true;
  scene.coarse_loss = 1e6;
  expect(TreeWork::kKeep, "no triangle has moved");
  scene.coarse_loss = 1e7;
  expect(TreeWork::kRebuild, "small leaves");
  scene.move();
  expect(TreeWork::kRebuild, "small leaves");
  scene.coarse_loss = 1e6;
  expect(TreeWork::kRefit, "refitted");
  scene.degraded = true;
  expect(TreeWork::kRebuildCoarsely, "degraded");
  scene.joining = Joining::kStrips;  // their nodes are a smaller part of the build
  scene.triangles = 40000;
  expect(TreeWork::kRebuild, "degraded");
  EXPECT_EQ(plan_tree(history(100000), {}, false).tree, TreeWork::kRebuild);
}

/// Coherent any-hit rays lose less in large leaves.
TEST(Plan, CoarseTreeForShadows) {
  const std::vector<Ray> rays = picture(256);
  const auto work = [&](std::uint32_t triangles, bool any) {
    return make_plan(history(triangles), RaysInPlace(View<const Ray>(rays)), any, false).tree;
  };
  EXPECT_EQ(work(30000, true), TreeWork::kRebuildCoarsely);
  EXPECT_EQ(work(30000, false), TreeWork::kRebuild);
  EXPECT_EQ(work(10000, true), TreeWork::kRebuild);
}

/// The refits of a coarse tree save what its rays lose.
TEST(Plan, CoarseTreeStaysWhereTrianglesMoveBetweenShadows) {
  const auto builds_finely_after_moves = [](bool together) {
    SceneHistory scene = history(200000);
    scene.built = scene.coarse = true;
    const TreeRays rays{100000, together};
    bool finely = false;
    for (int i = 0; i < 20 && !finely; ++i) {
      scene.trace(rays);
      scene.move();
      const Plan plan = plan_tree(scene, rays, false);
      EXPECT_EQ(plan.tree, TreeWork::kRefit);
      finely = plan.finely;
      scene.refit();
    }
    return finely;
  };
  EXPECT_FALSE(builds_finely_after_moves(true));
  EXPECT_TRUE(builds_finely_after_moves(false));
}

TEST(Plan, GivesReasonsOnRequest) {
  Random random(5);
  const std::vector<Ray> rays = disorder(1000, random);
  const Plan told = plan_of(history(100), rays);
  EXPECT_EQ(told.reasons.size(), 3u);
  for (const std::string& reason : told.reasons) {
    EXPECT_NE(reason.find(": "), std::string::npos) << reason;
    EXPECT_EQ(reason.find("nan"), std::string::npos) << reason;
  }
  const Plan silent = make_plan(history(100), RaysInPlace(View<const Ray>(rays)), false, false);
  EXPECT_TRUE(silent.reasons.empty());
  EXPECT_EQ(silent.tree, told.tree);
  EXPECT_EQ(silent.bundle, told.bundle);
}

/// Directions and origins at the limits of binary32 must not make any figure NaN.
TEST(Plan, ExtremeRays) {
  Random random(6);
  for (const float scale : {1e-44f, 1e-20f, 1e20f, 3e38f}) {
    std::vector<Ray> rays = disorder(500, random);
    for (Ray& ray : rays) {
      ray.origin = ray.origin * (0.2f * scale);
      ray.direction = ray.direction * scale;
      if (!(max_component(abs(ray.direction)) > 0)) ray.direction = {0, 0, 1e-45f};
    }
    for (const std::string& reason : plan_of(history(10), rays).reasons) {
      EXPECT_EQ(reason.find("nan"), std::string::npos) << reason;
      EXPECT_EQ(reason.find("inf"), std::string::npos) << reason;
    }
  }
}

TEST(Plan, WaitsLongerAfterEveryDegradedFineTree) {
  SceneHistory scene = history(1000);
  scene.moves = 5;
  scene.wait_longer();
  EXPECT_EQ(scene.patience, 9u);
  for (std::uint32_t last = scene.patience, i = 0; i < 40; ++i) {
    scene.moves = scene.patience;
    scene.wait_longer();
    EXPECT_GE(scene.patience, last) << i;
    last = scene.patience;
  }
}

}  // namespace
}  // namespace raysheaf::test
